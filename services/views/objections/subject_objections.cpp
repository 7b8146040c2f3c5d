#include "services/views/objections/subject_objections.hpp"

#include <algorithm>
#include <cctype>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "services/evaluation/result/members.hpp"
#include "services/views/language/objection_sentences.hpp"
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

template <class... Values>
void add_objection(const Sentence& sentence, std::vector<TranslatedText>& objections,
                   const Values&... values) {
  objections.push_back(
      in_all_languages([&](Language language) { return sentence(language, values...); }));
}

void hold_sensor(const DocumentSubject& subject, std::vector<TranslatedText>& objections) {
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
      add_objection(sentences::another_serial, objections, described->serial, source, serial);
    }
    const bool is_renamed = amended(subject.result.journal, source + "/model") &&
                            is_same_model(described->device, sensor.model);
    if (!is_renamed && !described->device.empty() && !is_same_model(described->device, model)) {
      add_objection(sentences::another_model, objections, described->device, source, model);
    }
  }
}

std::string local_day(const std::string& utc) {
  constexpr std::int64_t second_ns = 1'000'000'000;
  const std::int64_t utc_ns = parse_utc_text(utc);
  return utc_ns == 0 ? "" : fmt::format("{:%Y-%m-%d}", fmt::localtime(utc_ns / second_ns));
}

// For sentences.
TranslatedText file_of(const ReferenceStandard& reference) {
  return reference.file.empty() ? sentences::laboratory_file.translated()
                                : TranslatedText{reference.file, reference.file};
}

// Days as the language writes them.
template <class... Texts>
void add_objection_on_days(const Sentence& sentence, std::vector<TranslatedText>& objections,
                           const Texts&... texts) {
  objections.push_back(in_all_languages(
      [&](Language language) { return sentence(language, day_text(language, texts)...); }));
}

void hold_days_of(const CalibratedDevice& device, const std::string& began,
                  const std::string& ended, std::vector<TranslatedText>& objections) {
  if (device.issued > began) {
    add_objection_on_days(sentences::certificate_after_measurement, objections, device.name,
                          device.issued, began);
  }
  if (!device.valid_until.empty() && device.valid_until < ended) {
    add_objection_on_days(sentences::was_due, objections, device.name, device.valid_until, ended);
  }
}

// Of a device whose certificate must be known.
void hold_days_of_reference(const CalibratedDevice& device, const TranslatedText& file,
                            const std::string& began, const std::string& ended,
                            std::vector<TranslatedText>& objections) {
  const auto add = [&](const Sentence& sentence) {
    objections.push_back(in_all_languages(
        [&](Language language) { return sentence(language, file.in(language), device.name); }));
  };
  if (device.issued.empty()) {
    add(sentences::no_day_of_certificate);
  }
  if (device.valid_until.empty()) {
    add(sentences::no_end_of_validity);
  }
  hold_days_of(device, began, ended, objections);
}

void hold_days(const DocumentSubject& subject, std::vector<TranslatedText>& objections) {
  const std::string first = std::min(subject.began, subject.ended);
  const std::string began = std::max(first, local_day(subject.result.began_utc));
  const std::string local_end = local_day(subject.result.ended_utc);
  const std::string ended = local_end.empty() ? subject.ended : std::min(subject.ended, local_end);
  if (subject.sensor.received > began) {
    add_objection_on_days(sentences::received_after_measurement, objections,
                          subject.sensor.received, began);
  }
  for (const CalibratedDevice& device : subject.reference.devices) {
    hold_days_of_reference(device, file_of(subject.reference), began, ended, objections);
  }
  for (const CalibratedDevice& device : subject.laboratory.equipment) {
    hold_days_of(device, began, ended, objections);
  }
}

// Both may state a reference; the one of the run is in the documents.
void hold_references(const DocumentSubject& subject, std::vector<TranslatedText>& objections) {
  const ReferenceStandard& reference = subject.reference;
  const std::pair<const char*, const std::string&> needed[] = {
      {"serial", reference.devices.front().serial},
      {"certificate", reference.devices.front().certificate},
      {"issued_by", reference.devices.front().issued_by},
      {"traceability", reference.traceability}};
  for (const auto& [key, value] : needed) {
    if (value.empty()) {
      const std::string lacking = key;
      objections.push_back(in_all_languages([&](Language language) {
        return sentences::reference_lacks(language, file_of(reference).in(language), lacking);
      }));
    }
  }
  if (reference.file.empty() || !subject.laboratory.reference) {
    return;
  }
  const CalibratedDevice& measured = reference.devices.front();
  const CalibratedDevice& stated = subject.laboratory.reference->devices.front();
  if (!is_same_serial(measured.serial, stated.serial) ||
      measured.certificate != stated.certificate) {
    add_objection(sentences::another_reference, objections, measured.serial, measured.certificate,
                  reference.file, stated.serial, stated.certificate);
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

std::vector<TranslatedText> objections_to_subject(const DocumentSubject& subject) {
  std::vector<TranslatedText> objections;
  hold_sensor(subject, objections);
  hold_references(subject, objections);
  hold_days(subject, objections);
  return objections;
}

} // namespace dyncal::inline views
