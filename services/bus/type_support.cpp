#include "services/bus/type_support.hpp"

#include "services/bus/type_support_of.hpp"

namespace dyncal::bus {
namespace {

// Bounds as written in idl/dyncal.idl.
constexpr std::size_t name_bound = 64;     // bench, source, run, service, target
constexpr std::size_t channel_bound = 128; // "source/channel"

const KeyLayout one_name{{name_bound}, 0};
const KeyLayout two_names{{name_bound, name_bound}, 0};
const KeyLayout three_names{{name_bound, name_bound, name_bound}, 0};
const KeyLayout names_and_channel{{name_bound, name_bound, channel_bound}, 0};
const KeyLayout names_channel_and_step{{name_bound, name_bound, channel_bound}, 2};

} // namespace

template <>
const TypeSupport& type_support<SourceDescription>() {
  static const TypeSupport support =
      make_type_support<SourceDescription>("dyncal::SourceDescription", two_names);
  return support;
}

template <>
const TypeSupport& type_support<SourceStatus>() {
  static const TypeSupport support =
      make_type_support<SourceStatus>("dyncal::SourceStatus", two_names);
  return support;
}

template <>
const TypeSupport& type_support<SampleBlock>() {
  static const TypeSupport support =
      make_type_support<SampleBlock>("dyncal::SampleBlock", two_names);
  return support;
}

template <>
const TypeSupport& type_support<TriggeredRecord>() {
  static const TypeSupport support =
      make_type_support<TriggeredRecord>("dyncal::TriggeredRecord", two_names);
  return support;
}

template <>
const TypeSupport& type_support<AcsPhasor>() {
  static const TypeSupport support = make_type_support<AcsPhasor>("dyncal::AcsPhasor", two_names);
  return support;
}

template <>
const TypeSupport& type_support<Measurement>() {
  static const TypeSupport support =
      make_type_support<Measurement>("dyncal::Measurement", two_names);
  return support;
}

template <>
const TypeSupport& type_support<Excitation>() {
  static const TypeSupport support = make_type_support<Excitation>("dyncal::Excitation", two_names);
  return support;
}

template <>
const TypeSupport& type_support<CalibrationResult>() {
  static const TypeSupport support =
      make_type_support<CalibrationResult>("dyncal::CalibrationResult", names_channel_and_step);
  return support;
}

template <>
const TypeSupport& type_support<TransferFunction>() {
  static const TypeSupport support =
      make_type_support<TransferFunction>("dyncal::TransferFunction", names_and_channel);
  return support;
}

template <>
const TypeSupport& type_support<SampleClockReport>() {
  static const TypeSupport support =
      make_type_support<SampleClockReport>("dyncal::SampleClockReport", three_names);
  return support;
}

template <>
const TypeSupport& type_support<ServiceStatus>() {
  static const TypeSupport support =
      make_type_support<ServiceStatus>("dyncal::ServiceStatus", two_names);
  return support;
}

template <>
const TypeSupport& type_support<Command>() {
  static const TypeSupport support = make_type_support<Command>("dyncal::Command", one_name);
  return support;
}

} // namespace dyncal::bus
