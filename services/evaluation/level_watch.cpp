#include "services/evaluation/level_watch.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "services/contract/excitation_quantity.hpp"
#include "services/evaluation/record/channel_level.hpp"

namespace dyncal::inline evaluation {
namespace {

double highest_level_m_s2(const Recipe& recipe, const std::string& frequency_text_hz) {
  double highest = 0.0;
  for (const RecipeStep& step : recipe.steps) {
    if (step.frequency_text_hz == frequency_text_hz) {
      highest = std::max(highest, step.level_m_s2);
    }
  }
  return highest;
}

// Of a multi-sine, whose lines cannot be told apart in so short a window: the peak of all, where
// the channel has the quantity of the levels.
std::optional<double> peak_in(const SourceRecord& reference, std::size_t channel,
                              const TimeInterval& window, const std::string& name,
                              const analysis::Frequency& frequency) {
  const auto factor = acceleration_factor(reference.description(), name, frequency.angular());
  if (factor != acceleration_factor(reference.description(), name, 2.0 * frequency.angular())) {
    return std::nullopt;
  }
  const std::vector<double> values = part_of(reference, channel, window, frequency).values;
  if (values.empty()) {
    return std::nullopt;
  }
  const auto [lowest, highest] = std::ranges::minmax(values);
  return *factor * 0.5 * (highest - lowest);
}

double sum_of_levels_m_s2(const Recipe& recipe) {
  double sum = 0.0;
  for (std::size_t line = 0; line < recipe.lines_at_once(); ++line) {
    sum += recipe.steps[line].level_m_s2;
  }
  return sum;
}

} // namespace

std::optional<std::string> LevelWatch::look(const SourceRecord& reference,
                                            const RecipeStep& planned) {
  const auto stamps = reference.stamps_ns();
  if (stamps.empty() || !reference.described()) {
    return std::nullopt;
  }
  const auto window_ns = std::llround(1e9 * level_window_s(planned.frequency.hz()));
  const std::int64_t newest_ns = stamps.back();
  if (looked_ns_ && newest_ns >= *looked_ns_ && newest_ns - *looked_ns_ < window_ns) {
    return std::nullopt;
  }
  const auto channel = reference.channel(recipe_.reference().channel);
  if (!channel || !acceleration_factor(reference.description(), recipe_.reference().channel,
                                       planned.frequency.angular())) {
    return std::nullopt;
  }
  looked_ns_ = newest_ns;
  const TimeInterval window{newest_ns - window_ns, newest_ns};
  const bool multisine = recipe_.is_multisine();
  const auto level = multisine ? peak_in(reference, *channel, window, recipe_.reference().channel,
                                         planned.frequency)
                               : level_in(reference, *channel, window, planned.frequency);
  const double planned_m_s2 = multisine ? sum_of_levels_m_s2(recipe_)
                                        : highest_level_m_s2(recipe_, planned.frequency_text_hz);
  if (!level || *level <= max_excess * planned_m_s2) {
    return std::nullopt;
  }
  return fmt::format("step {}, {} Hz: {} shows {:.3g} m/s^2 where {:.3g} m/s^2 are planned; the "
                     "excitation is stopped. Is generator.level_per_volt right for this exciter, "
                     "and the gain of the amplifier?",
                     planned.step, planned.frequency_text_hz, recipe_.reference().text(), *level,
                     planned_m_s2);
}

} // namespace dyncal::inline evaluation
