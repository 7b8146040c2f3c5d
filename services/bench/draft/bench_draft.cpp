#include "services/bench/draft/bench_draft.hpp"

#include <algorithm>

namespace dyncal::inline bench::bench_draft {
namespace {

template <class Kind>
std::optional<Kind> parse(const std::vector<std::string>& names, std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? std::nullopt
                              : std::optional(static_cast<Kind>(found - names.begin()));
}

} // namespace

std::string channel_of(const BenchDraft& draft) {
  if (!draft.sensor_channel.empty()) {
    return draft.sensor_channel;
  }
  return draft.sensor == SensorKind::analogue ? "sensor" : "acceleration_z";
}

const std::vector<std::string>& sensor_kinds() {
  static const std::vector<std::string> names{"smartup", "file", "can", "series", "analogue"};
  return names;
}

const std::vector<std::string>& acs_kinds() {
  static const std::vector<std::string> names{"socket", "file"};
  return names;
}

const std::vector<std::string>& generator_kinds() {
  static const std::vector<std::string> names{"scpi", "by-hand", "none"};
  return names;
}

std::optional<SensorKind> parse_sensor_kind(std::string_view name) {
  return parse<SensorKind>(sensor_kinds(), name);
}

std::optional<AcsKind> parse_acs_kind(std::string_view name) {
  return parse<AcsKind>(acs_kinds(), name);
}

std::optional<GeneratorKind> parse_generator_kind(std::string_view name) {
  return parse<GeneratorKind>(generator_kinds(), name);
}

} // namespace dyncal::inline bench::bench_draft
