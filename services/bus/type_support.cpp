#include "services/bus/type_support.hpp"

#include <cstring>

#include "services/bus/type_support_of.hpp"

namespace dyncal::bus {
namespace {

// Bounds as written in idl/dyncal.idl.
constexpr std::size_t name_bound = 64;     // bench, source, run, service, target
constexpr std::size_t channel_bound = 128; // "source/channel"
constexpr std::size_t asker_bound = 128;   // service and run

const KeyLayout two_names{{name_bound, name_bound}, 0};
const KeyLayout three_names{{name_bound, name_bound, name_bound}, 0};
const KeyLayout names_and_channel{{name_bound, name_bound, channel_bound}, 0};
const KeyLayout names_and_step{{name_bound, name_bound, name_bound}, 2};
const KeyLayout names_and_asker{{name_bound, name_bound, asker_bound}, 0};
const KeyLayout names_channel_and_step{{name_bound, name_bound, channel_bound}, 2};

constexpr char header[cdr_header_bytes] = {0, 1, 0, 0}; // plain CDR, little-endian
constexpr char no_checksum[checksum_bytes] = {};

} // namespace

EncodedMessage encode(const TypeSupport& type, const void* sample) {
  std::string bytes(type.serialized_size(sample), '\0');
  bytes.resize(type.serialize(sample, bytes.data(), bytes.size()));
  return bytes.empty() ? nullptr : std::make_shared<const std::string>(std::move(bytes));
}

bool is_whole(const TypeSupport& type, const void* sample, std::string_view bytes) {
  return bytes.size() == type.serialized_size(sample) &&
         std::memcmp(bytes.data(), header, sizeof header) == 0 &&
         std::memcmp(bytes.data() + bytes.size() - checksum_bytes, no_checksum,
                     sizeof no_checksum) != 0;
}

template <>
const TypeSupport& type_support<wire::SourceDescription>() {
  static const TypeSupport support =
      make_type_support<wire::SourceDescription>("dyncal::wire::SourceDescription", two_names);
  return support;
}

template <>
const TypeSupport& type_support<wire::SourceStatus>() {
  static const TypeSupport support =
      make_type_support<wire::SourceStatus>("dyncal::wire::SourceStatus", two_names);
  return support;
}

template <>
const TypeSupport& type_support<wire::SampleBlock>() {
  static const TypeSupport support =
      make_type_support<wire::SampleBlock>("dyncal::wire::SampleBlock", two_names);
  return support;
}

template <>
const TypeSupport& type_support<wire::TriggeredRecord>() {
  static const TypeSupport support =
      make_type_support<wire::TriggeredRecord>("dyncal::wire::TriggeredRecord", two_names);
  return support;
}

template <>
const TypeSupport& type_support<wire::AcsStep>() {
  static const TypeSupport support =
      make_type_support<wire::AcsStep>("dyncal::wire::AcsStep", names_and_step);
  return support;
}

template <>
const TypeSupport& type_support<wire::Measurement>() {
  static const TypeSupport support =
      make_type_support<wire::Measurement>("dyncal::wire::Measurement", two_names);
  return support;
}

template <>
const TypeSupport& type_support<wire::Excitation>() {
  static const TypeSupport support =
      make_type_support<wire::Excitation>("dyncal::wire::Excitation", two_names);
  return support;
}

template <>
const TypeSupport& type_support<wire::CalibrationResult>() {
  static const TypeSupport support = make_type_support<wire::CalibrationResult>(
      "dyncal::wire::CalibrationResult", names_channel_and_step);
  return support;
}

template <>
const TypeSupport& type_support<wire::TransferFunction>() {
  static const TypeSupport support = make_type_support<wire::TransferFunction>(
      "dyncal::wire::TransferFunction", names_and_channel);
  return support;
}

template <>
const TypeSupport& type_support<wire::SampleClockReport>() {
  static const TypeSupport support =
      make_type_support<wire::SampleClockReport>("dyncal::wire::SampleClockReport", three_names);
  return support;
}

template <>
const TypeSupport& type_support<wire::ServiceStatus>() {
  static const TypeSupport support =
      make_type_support<wire::ServiceStatus>("dyncal::wire::ServiceStatus", three_names);
  return support;
}

template <>
const TypeSupport& type_support<wire::Command>() {
  static const TypeSupport support =
      make_type_support<wire::Command>("dyncal::wire::Command", two_names);
  return support;
}

template <>
const TypeSupport& type_support<wire::CatchUpRequest>() {
  static const TypeSupport support =
      make_type_support<wire::CatchUpRequest>("dyncal::wire::CatchUpRequest", names_and_asker);
  return support;
}

template <>
const TypeSupport& type_support<wire::ClockRequest>() {
  static const TypeSupport support =
      make_type_support<wire::ClockRequest>("dyncal::wire::ClockRequest", two_names);
  return support;
}

template <>
const TypeSupport& type_support<wire::ClockAnswer>() {
  static const TypeSupport support =
      make_type_support<wire::ClockAnswer>("dyncal::wire::ClockAnswer", three_names);
  return support;
}

template <>
const TypeSupport& type_support<wire::LinkProbe>() {
  static const TypeSupport support =
      make_type_support<wire::LinkProbe>("dyncal::wire::LinkProbe", two_names);
  return support;
}

template <>
const TypeSupport& type_support<wire::LinkEcho>() {
  static const TypeSupport support =
      make_type_support<wire::LinkEcho>("dyncal::wire::LinkEcho", three_names);
  return support;
}

} // namespace dyncal::bus
