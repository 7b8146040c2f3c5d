#include "services/views/certificate/certificate_contents.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/rand.h>

#include "services/base/version.hpp"
#include "services/contract/digest.hpp"
#include "services/views/certificate/ratio_unit.hpp"
#include "services/views/conformity/asked_conformity.hpp"
#include "services/views/lab_file/documented_conditions.hpp"
#include "services/views/language/translated_texts.hpp"
#include "services/views/objections/objections.hpp"
#include "services/views/objections/subject_objections.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

tl::unexpected<Error> missing(const std::filesystem::path& file, const std::string& what,
                              const std::string& why) {
  return fail(ErrorCode::bad_file,
              fmt::format("{}:1: {} is missing: {}", file.string(), what, why));
}

std::string new_uuid() {
  std::array<unsigned char, 16> bytes{};
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
    return {};
  }
  bytes[6] = static_cast<unsigned char>((bytes[6] & 0x0fU) | 0x40U); // version 4
  bytes[8] = static_cast<unsigned char>((bytes[8] & 0x3fU) | 0x80U);
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    text += fmt::format("{}{:02x}", i == 4 || i == 6 || i == 8 || i == 10 ? "-" : "", bytes.at(i));
  }
  return text;
}

// The sensor as its source described itself to the run.
SensorFile described_sensor(const StoredResult& result, const std::string& channel) {
  SensorFile sensor;
  if (const auto source = described_source(result, channel)) {
    sensor.model = source->device;
    sensor.serial = source->serial;
    sensor.firmware = source->firmware;
  }
  return sensor;
}

Expected<void> gather_sensor(const CertificateRequest& request, CertificateContents& contents) {
  if (request.sensor) {
    contents.sensor = *request.sensor;
    amend(contents.result.journal, contents.sensor);
    return {};
  }
  contents.sensor = described_sensor(contents.result, contents.channels.front().channel);
  if (contents.sensor.serial.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: the run does not know the serial number of the sensor; state the "
                            "sensor with --sensor SENSOR.toml",
                            contents.result.file.string()));
  }
  return {};
}

Expected<void> gather_laboratory(const CertificateRequest& request, CertificateContents& contents) {
  DYNCAL_TRY(contents.laboratory, read_laboratory_file(request.laboratory));
  contents.languages =
      request.languages.empty() ? contents.laboratory.languages : request.languages;
  DYNCAL_TRY(contents.reference, documented_reference(contents.result, contents.laboratory));
  return {};
}

Expected<void> gather_customer(CertificateContents& contents) {
  const auto& of_sensor = contents.sensor.customer;
  const auto& of_laboratory = contents.laboratory.customer;
  if (!of_sensor && !of_laboratory) {
    return missing(contents.laboratory.path, "table [customer]",
                   "a certificate names its customer, here or in the sensor file");
  }
  contents.customer = of_sensor ? *of_sensor : *of_laboratory;
  amend(contents.result.journal, contents.customer);
  auto documented = documented_conditions(contents.result, contents.sensor.conditions.empty()
                                                               ? contents.laboratory.conditions
                                                               : contents.sensor.conditions);
  contents.conditions = std::move(documented.conditions);
  contents.condition_origins = std::move(documented.origins);
  return {};
}

Expected<void> gather_dates(const CertificateRequest& request, CertificateContents& contents) {
  constexpr std::size_t date_length = 10;
  contents.issued = fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
  contents.began = contents.result.began_utc.substr(0, date_length);
  contents.ended = contents.result.ended_utc.substr(0, date_length);
  if (contents.began.empty() || contents.ended.empty()) {
    contents.began = contents.ended = request.performed;
  }
  if (!request.performed.empty() &&
      (request.performed < contents.began || request.performed > contents.ended)) {
    return fail(ErrorCode::bad_argument,
                fmt::format("{}: was measured on {}, not on {}; leave --performed out",
                            contents.result.file.string(), contents.began, request.performed));
  }
  if (contents.began.empty()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("{}: the run does not know when it was measured, for its stamps are "
                            "not in UTC; state the day with --performed YYYY-MM-DD",
                            contents.result.file.string()));
  }
  return {};
}

std::vector<std::string> channel_names(const CertificateContents& contents) {
  std::vector<std::string> names;
  for (const CertifiedChannel& channel : contents.channels) {
    names.push_back(channel.channel);
  }
  return names;
}

Expected<void> gather_conformity(const CertificateRequest& request, CertificateContents& contents) {
  DYNCAL_TRY(contents.conformity, asked_conformity(contents.result, channel_names(contents),
                                                   request.tolerances, contents.sensor.tolerances));
  return {};
}

void object_to_subject(CertificateContents& contents) {
  std::ranges::move(objections_to_subject({.result = contents.result,
                                           .channels = channel_names(contents),
                                           .sensor = contents.sensor,
                                           .laboratory = contents.laboratory,
                                           .reference = contents.reference,
                                           .began = contents.began,
                                           .ended = contents.ended}),
                    std::back_inserter(contents.objections));
}

// As large as it may be: a recording is read in parts.
Expected<void> hash_recording(const std::filesystem::path& run, CertificateContents& contents) {
  const std::filesystem::path recording = run / "recording.mcap";
  std::error_code unknown;
  if (!std::filesystem::is_directory(run, unknown) ||
      !std::filesystem::exists(recording, unknown)) {
    return {};
  }
  std::ifstream stream(recording, std::ios::binary);
  Digest digest;
  std::string part(1U << 20U, '\0');
  while (stream.read(part.data(), static_cast<std::streamsize>(part.size())) ||
         stream.gcount() > 0) {
    digest.add(part.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (!stream.eof()) {
    return fail(
        ErrorCode::bad_file,
        fmt::format("{}: cannot be read whole, so its hash cannot be stated", recording.string()));
  }
  contents.recording_sha256 = digest.hex();
  return {};
}

Expected<void> gather_values(const CertificateRequest& request, CertificateContents& contents) {
  const std::vector<std::string> names =
      request.channels.empty() ? responding_channels(contents.result) : request.channels;
  if (names.empty()) {
    return fail(ErrorCode::no_result, fmt::format("{}: no channel responds to the excitation, so "
                                                  "there is nothing to certify",
                                                  contents.result.file.string()));
  }
  DYNCAL_TRY(contents.channels, certified_channels(contents.result, names));
  contents.objections = request.held.objections;
  std::ranges::move(objections_to(contents.result, names), std::back_inserter(contents.objections));
  contents.flags = stated_flags(contents.result, names);
  contents.has_monte_carlo = std::all_of(
      contents.result.points.begin(), contents.result.points.end(), [&](const StoredPoint& point) {
        return !point.valid || point.monte_carlo ||
               std::find(names.begin(), names.end(), point.channel) == names.end();
      });
  return {};
}

Expected<void> refuse_unless_forced(const CertificateRequest& request,
                                    const CertificateContents& contents) {
  constexpr std::size_t max_shown = 5;
  if (contents.objections.empty() || request.force) {
    return {};
  }
  return fail(
      ErrorCode::no_result,
      fmt::format(
          "{}: no certificate: {}. Measure again, leave channels out with "
          "--channel, or --force a certificate that says all this",
          contents.result.file.string(),
          fmt::join(first_of(texts_in(Language::english, contents.objections), max_shown), "; ")));
}

} // namespace

Expected<std::vector<CertifiedChannel>>
certified_channels(const StoredResult& result, const std::vector<std::string>& channels) {
  std::vector<CertifiedChannel> certified;
  for (const std::string& name : channels) {
    CertifiedChannel channel{.channel = name, .unit = {}, .values = {}};
    for (StoredValue& value : result.values_of(name)) {
      if (can_be_stated(value)) {
        channel.values.push_back(std::move(value));
      }
    }
    if (channel.values.empty()) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("{}: channel '{}' has no value that could be certified",
                              result.file.string(), name));
    }
    const auto unit = ratio_in_d_si(channel.values.front().unit);
    if (!unit) {
      return fail(ErrorCode::bad_file,
                  fmt::format("{}: the unit of {} is '{}', which has no form in the SI; state the "
                              "units of sensor and reference in the bench file and evaluate the "
                              "run again",
                              result.file.string(), name, channel.values.front().unit));
    }
    channel.unit = *unit;
    certified.push_back(std::move(channel));
  }
  return certified;
}

Expected<CertificateContents> gather_certificate(const CertificateRequest& request) {
  CertificateContents contents;
  contents.result = request.held.result;
  contents.provenance = request.held.statements;
  using Step = Expected<void> (*)(const CertificateRequest&, CertificateContents&);
  for (const Step step : {Step{gather_values}, Step{gather_laboratory}, Step{gather_sensor},
                          Step{gather_conformity}, Step{gather_dates}}) {
    DYNCAL_TRY(step(request, contents));
  }
  object_to_subject(contents);
  for (auto done : {gather_customer(contents), refuse_unless_forced(request, contents),
                    hash_recording(request.run, contents)}) {
    DYNCAL_TRY(done);
  }
  contents.number = request.number.empty() ? contents.sensor.certificate_number : request.number;
  contents.replaces = request.replaces;
  contents.replaced_identifier = request.replaced_identifier;
  contents.replaced_sha256 = request.replaced_sha256;
  contents.identifier = new_uuid();
  contents.software = software_version();
  return contents;
}

} // namespace dyncal::inline views
