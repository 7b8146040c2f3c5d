// Whatever stands in a laboratory, sensor or reference file: no crash, no hang; it is refused with
// a sentence that names the file, or read, and then every text that it holds is one that a document
// may carry.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "services/bench/file/reference_file.hpp"
#include "services/views/lab_file/laboratory_file.hpp"
#include "services/views/lab_file/sensor_file.hpp"

namespace {

using namespace dyncal;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

bool is_printable(const std::string& text) {
  return std::none_of(text.begin(), text.end(), [](unsigned char c) {
    return (c < 0x20 && c != '\n' && c != '\t') || c == 0x7f;
  });
}

void check(const Contact& contact) {
  require(!contact.name.empty() && !contact.city.empty() && contact.country.size() == 2);
  for (const std::string& text : {contact.name, contact.street, contact.city, contact.email}) {
    require(is_printable(text));
  }
}

void check(const LaboratoryFile& file) {
  check(file.laboratory);
  if (file.customer) {
    check(*file.customer);
  }
  for (const Person& person : file.persons) {
    require(!person.name.empty() && is_printable(person.name) && is_printable(person.role));
  }
  if (file.reference) {
    require(!file.reference->devices.front().certificate.empty() &&
            !file.reference->devices.front().serial.empty());
  }
}

// Of what it names nothing is there.
void check_reference(const std::string& text) {
  NamedFiles files("/nowhere", NamedFiles::Place::as_named);
  const auto reference = parse_reference_file(text, "reference.toml", files);
  if (!reference) {
    require(reference.error().message.starts_with("/nowhere/reference.toml"));
    return;
  }
  require(!reference->standard.devices.empty());
  for (const analysis::ReferenceCalibrationPoint& point : reference->response) {
    require(std::isfinite(point.magnitude) && point.magnitude > 0.0);
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  const auto laboratory = parse_laboratory_file(text, "/nowhere/lab.toml");
  if (laboratory) {
    check(*laboratory);
  } else {
    require(laboratory.error().message.starts_with("/nowhere/lab.toml"));
  }
  const auto sensor = parse_sensor_file(text, "/nowhere/sensor.toml");
  if (sensor) {
    require(!sensor->serial.empty() && is_printable(sensor->serial));
  } else {
    require(sensor.error().message.starts_with("/nowhere/sensor.toml"));
  }
  check_reference(text);
  return 0;
}
