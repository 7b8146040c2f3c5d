#include "services/bench/file/calibrated_device.hpp"

#include <chrono>
#include <sstream>

#include <fmt/core.h>

#include "services/bench/file/toml_lines.hpp"

namespace dyncal::inline bench {
namespace {

// The day that many months after another one; the last of a month that is too short.
std::string day_after(const std::string& day, int months) {
  std::istringstream stream(day);
  int year = 0;
  unsigned month = 0;
  unsigned number = 0;
  char dash = 0;
  stream >> year >> dash >> month >> dash >> number;
  using namespace std::chrono; // NOLINT(google-build-using-namespace): of calendars
  year_month_day later =
      year_month_day{std::chrono::year(year), std::chrono::month(month), std::chrono::day(number)} +
      std::chrono::months(months);
  if (!later.ok()) {
    later = later.year() / later.month() / last;
  }
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(later.year()),
                     static_cast<unsigned>(later.month()), static_cast<unsigned>(later.day()));
}

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
  return issued.empty() ? "" : day_after(issued, months);
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
