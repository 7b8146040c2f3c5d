#include "services/evaluation/method/step_settling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/core.h>

#include "analysis/sine/sine_fit.hpp"
#include "analysis/step/settling.hpp"

namespace dyncal::inline evaluation {
namespace {

// Of each settling column, in their order; the reason where there is none.
std::vector<analysis::Expected<double>> settling_times_s(const RecipeStep& step,
                                                         double frequency_search_rel,
                                                         const SettlingColumns& source) {
  const StepSamples& samples = source.samples;
  analysis::Frequency frequency = step.frequency;
  if (frequency_search_rel > 0.0 && !samples.stamps_ns.empty()) {
    const std::array sync{std::span<const double>(samples.columns[source.sync])};
    const auto fit = analysis::fit_sine_and_frequency(
        step.frequency, frequency_search_rel, samples.stamps_ns.front(), samples.stamps_ns, sync);
    if (!fit) {
      return std::vector<analysis::Expected<double>>(source.settling.size(), fail(fit.error()));
    }
    frequency = fit->frequency;
  }
  std::vector<analysis::Expected<double>> times;
  for (const std::size_t column : source.settling) {
    times.push_back(analysis::find_settling(frequency, samples.stamps_ns, samples.columns[column])
                        .map([](const auto& found) { return found.settling_s; }));
  }
  return times;
}

} // namespace

StepSettling find_settling_of_step(const RecipeStep& step, double frequency_search_rel,
                                   const SettlingColumns& acs, const SettlingColumns& sensor) {
  const auto reference = settling_times_s(step, frequency_search_rel, acs).front();
  if (!reference) {
    return {step.settling_s,
            Flag{ResultFlag::settling_not_found,
                 fmt::format("{}, {} s left out: {}", to_string(ResultFlag::settling_not_found),
                             step.settling_s, reference.error().message)}};
  }
  double max_duration_s = *reference;
  for (const auto& channel : settling_times_s(step, frequency_search_rel, sensor)) {
    max_duration_s = std::max(max_duration_s, channel.value_or(0.0));
  }
  if (max_duration_s > step.settling_s) {
    return {step.settling_s,
            Flag{ResultFlag::settles_too_long,
                 fmt::format("{} {:.3g} s, {} s left out", to_string(ResultFlag::settles_too_long),
                             max_duration_s, step.settling_s)}};
  }
  return {max_duration_s};
}

TimeInterval without_settling(TimeInterval interval, double settling_s, double duration_s) {
  const auto ns = [](double seconds) {
    return static_cast<std::int64_t>(std::llround(seconds * 1e9));
  };
  interval.begin_ns += ns(settling_s);
  interval.end_ns = std::min(interval.end_ns, interval.begin_ns + ns(duration_s) - 1);
  return interval;
}

SettlingColumns sensor_columns(const SelectedChannels& sensor, std::size_t first) {
  SettlingColumns columns{sensor.samples(), 0, {}};
  for (std::size_t column = first; column < sensor.size(); ++column) {
    columns.settling.push_back(column);
  }
  return columns;
}

} // namespace dyncal::inline evaluation
