#include "services/bench/file/calibrated_device.hpp"

#include "services/base/calendar_day.hpp"
#include "services/bench/file/toml_lines.hpp"

namespace dyncal::inline bench {
namespace {

// The day itself, or an interval after `issued`.
std::string validity_of(TomlTable& table, const std::string& issued) {
  std::string stated = date_of(table, "valid_until");
  if (!table.has("interval_months")) {
    return stated;
  }
  const int months = table.whole_number("interval_months", 0, 1);
  if (!stated.empty()) {
    table.refuse("interval_months", "stands in place of 'valid_until'");
  }
  return issued.empty() ? "" : months_after(issued, months);
}

} // namespace

CalibratedDevice read_calibrated_device(TomlTable& table) {
  CalibratedDevice device{.name = required_line(table, "name"),
                          .manufacturer = line_of(table, "manufacturer"),
                          .model = line_of(table, "model"),
                          .serial = line_of(table, "serial"),
                          .certificate = line_of(table, "certificate"),
                          .issued_by = line_of(table, "issued_by"),
                          .issued = date_of(table, "issued"),
                          .valid_until = {}};
  device.valid_until = validity_of(table, device.issued);
  if (!device.valid_until.empty() && device.valid_until < device.issued) {
    table.refuse("valid_until", "is before 'issued'");
  }
  return device;
}

ReferenceStandard read_reference_standard(TomlTable& table) {
  ReferenceStandard reference;
  reference.devices.push_back(read_calibrated_device(table));
  if (table.has("standard")) {
    reference.standard = table.one_of("standard", {"ISO 16063-11", "ISO 16063-21"}, "");
  }
  reference.traceability = line_of(table, "traceability");
  return reference;
}

} // namespace dyncal::inline bench
