#include "services/views/objections/subject_objections.hpp"

#include <algorithm>
#include <cctype>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "services/evaluation/result/members.hpp"
#include "services/views/report/amendments.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

std::string letters_and_digits(const std::string& text) {
  std::string kept;
  for (const unsigned char c : text) {
    if (std::isalnum(c) != 0) {
      kept += static_cast<char>(std::tolower(c));
    }
  }
  return kept;
}

// A maker's name may stand before a model.
bool is_same_model(const std::string& one, const std::string& other) {
  const std::string a = letters_and_digits(one);
  const std::string b = letters_and_digits(other);
  return a.find(b) != std::string::npos || b.find(a) != std::string::npos;
}

bool is_same_serial(const std::string& one, const std::string& other) {
  return letters_and_digits(one) == letters_and_digits(other);
}

void add_difference(const std::string& what, const std::string& key, const std::string& source,
                    const std::string& measured, const std::string& stated,
                    std::vector<std::string>& objections) {
  objections.push_back(
      fmt::format("the run was measured with {} '{}' (source {}), the sensor file says '{}'; if it "
                  "is the same sensor, state in its file {} = \"{}\"",
                  what, measured, source, stated, key, measured));
}

void hold_sensor(const DocumentSubject& subject, std::vector<std::string>& objections) {
  std::vector<std::string> seen;
  for (const std::string& channel : subject.channels) {
    const std::string source = channel.substr(0, channel.find('/'));
    const auto described = described_source(subject.result, channel);
    if (!described || std::ranges::find(seen, source) != seen.end()) {
      continue;
    }
    seen.push_back(source);
    const SensorFile& sensor = subject.sensor;
    const std::string& serial =
        sensor.electronic_serial.empty() ? sensor.serial : sensor.electronic_serial;
    const std::string& model =
        sensor.electronic_model.empty() ? sensor.model : sensor.electronic_model;
    if (described->serial.empty()) {
      continue; // a file, or a bus that knows no sensor by name
    }
    // An amendment is the stated override of what a source says of itself.
    const bool is_corrected = amended(subject.result.journal, source + "/serial") &&
                              is_same_serial(described->serial, sensor.serial);
    if (!is_corrected && !is_same_serial(described->serial, serial)) {
      add_difference("serial number", "electronic_serial", source, described->serial, serial,
                     objections);
    }
    const bool is_renamed = amended(subject.result.journal, source + "/model") &&
                            is_same_model(described->device, sensor.model);
    if (!is_renamed && !described->device.empty() && !is_same_model(described->device, model)) {
      add_difference("model", "electronic_model", source, described->device, model, objections);
    }
  }
}

std::string local_day(const std::string& utc) {
  constexpr std::int64_t second_ns = 1'000'000'000;
  const std::int64_t utc_ns = parse_utc_text(utc);
  return utc_ns == 0 ? "" : fmt::format("{:%Y-%m-%d}", fmt::localtime(utc_ns / second_ns));
}

// For sentences.
std::string file_of(const ReferenceStandard& reference) {
  return reference.file.empty() ? "the laboratory file" : reference.file;
}

void hold_days_of(const CalibratedDevice& device, const std::string& began,
                  const std::string& ended, std::vector<std::string>& objections) {
  if (device.issued > began) {
    objections.push_back(fmt::format("the certificate of the {} is of {}, after the measurement of "
                                     "{}",
                                     device.name, device.issued, began));
  }
  if (!device.valid_until.empty() && device.valid_until < ended) {
    objections.push_back(fmt::format("the {} was to be calibrated again by {}, before the "
                                     "measurement of {}",
                                     device.name, device.valid_until, ended));
  }
}

// Of a device whose certificate must be known.
void hold_days_of_reference(const CalibratedDevice& device, const std::string& file,
                            const std::string& began, const std::string& ended,
                            std::vector<std::string>& objections) {
  if (device.issued.empty()) {
    objections.push_back(fmt::format("{} does not say when the certificate of the {} was issued "
                                     "(issued)",
                                     file, device.name));
  }
  if (device.valid_until.empty()) {
    objections.push_back(fmt::format("{} does not say until when the {} may be used (valid_until, "
                                     "or interval_months)",
                                     file, device.name));
  }
  hold_days_of(device, began, ended, objections);
}

void hold_days(const DocumentSubject& subject, std::vector<std::string>& objections) {
  const std::string first = std::min(subject.began, subject.ended);
  const std::string began = std::max(first, local_day(subject.result.began_utc));
  const std::string local_end = local_day(subject.result.ended_utc);
  const std::string ended = local_end.empty() ? subject.ended : std::min(subject.ended, local_end);
  if (subject.sensor.received > began) {
    objections.push_back(fmt::format("the sensor was received on {}, after the measurement of {}",
                                     subject.sensor.received, began));
  }
  for (const CalibratedDevice& device : subject.reference.devices) {
    hold_days_of_reference(device, file_of(subject.reference), began, ended, objections);
  }
  for (const CalibratedDevice& device : subject.laboratory.equipment) {
    hold_days_of(device, began, ended, objections);
  }
}

// Both may state a reference; the one of the run is in the documents.
void hold_references(const DocumentSubject& subject, std::vector<std::string>& objections) {
  const ReferenceStandard& reference = subject.reference;
  const std::pair<const char*, const std::string&> needed[] = {
      {"serial", reference.devices.front().serial},
      {"certificate", reference.devices.front().certificate},
      {"issued_by", reference.devices.front().issued_by},
      {"traceability", reference.traceability}};
  for (const auto& [key, value] : needed) {
    if (value.empty()) {
      objections.push_back(fmt::format("{} does not state reference.{}", file_of(reference), key));
    }
  }
  if (reference.file.empty() || !subject.laboratory.reference) {
    return;
  }
  const CalibratedDevice& measured = reference.devices.front();
  const CalibratedDevice& stated = subject.laboratory.reference->devices.front();
  if (!is_same_serial(measured.serial, stated.serial) ||
      measured.certificate != stated.certificate) {
    objections.push_back(fmt::format(
        "the run was measured against reference '{}' with certificate '{}' ({}), the laboratory "
        "file names '{}' with '{}': leave its table [reference] out",
        measured.serial, measured.certificate, reference.file, stated.serial, stated.certificate));
  }
}

tl::unexpected<Error> missing(const LaboratoryFile& file, const std::string& what,
                              const std::string& why) {
  return fail(ErrorCode::bad_file,
              fmt::format("{}:1: {} is missing: {}", file.path.string(), what, why));
}

} // namespace

const ReferenceStandard* reference_of(const StoredResult& result,
                                      const LaboratoryFile* laboratory) {
  if (result.corrections && result.corrections->reference_standard) {
    return &*result.corrections->reference_standard;
  }
  return laboratory != nullptr && laboratory->reference ? &*laboratory->reference : nullptr;
}

Expected<ReferenceStandard> documented_reference(const StoredResult& result,
                                                 const LaboratoryFile& laboratory) {
  if (laboratory.persons.empty()) {
    return missing(laboratory, "table [[person]]", "a certificate names who is responsible for it");
  }
  const ReferenceStandard* const reference = reference_of(result, &laboratory);
  if (reference == nullptr) {
    return missing(laboratory, "table [reference]",
                   "a certificate states what its values are traceable to; better, the bench names "
                   "a reference file (corrections.reference)");
  }
  if (!reference->standard.empty()) {
    return *reference;
  }
  const std::string meaning = "ISO 16063-11 for a laser interferometer, ISO 16063-21 for a "
                              "reference transducer";
  if (reference->file.empty()) {
    return missing(laboratory, "key 'reference.standard'", meaning);
  }
  return fail(ErrorCode::bad_file,
              fmt::format("{}: key 'reference.standard' is missing: {}; state it and evaluate the "
                          "run anew",
                          reference->file, meaning));
}

std::vector<std::string> objections_to_subject(const DocumentSubject& subject) {
  std::vector<std::string> objections;
  hold_sensor(subject, objections);
  hold_references(subject, objections);
  hold_days(subject, objections);
  return objections;
}

} // namespace dyncal::inline views
