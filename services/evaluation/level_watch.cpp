#include "services/evaluation/level_watch.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "analysis/base/statistics.hpp"
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

struct ShownLevel {
  double shown_m_s2 = 0.0;
  double planned_m_s2 = 0.0;
  std::string of; // what is compared: the step, or all that are excited with it
  const char* unit = "m/s^2";
};

std::optional<ShownLevel> level_of_step(const Recipe& recipe, const SourceRecord& reference,
                                        std::size_t channel, const TimeInterval& window,
                                        const RecipeStep& planned) {
  const auto level = level_in(reference, channel, window, planned.frequency);
  return level ? std::optional(ShownLevel{
                     *level, highest_level_m_s2(recipe, planned.frequency_text_hz),
                     fmt::format("step {}, {} Hz", planned.step, planned.frequency_text_hz)})
               : std::nullopt;
}

// The lines of a multi-sine cannot be told apart in so short a window, but Schroeder's phases keep
// its rms as it is in the whole. Only where the channel has the quantity of the levels.
std::optional<ShownLevel> rms_of_lines(const Recipe& recipe, const SourceRecord& reference,
                                       std::size_t channel, const TimeInterval& window,
                                       const RecipeStep& planned) {
  const std::string& name = recipe.reference().channel;
  const double angular_hz = planned.frequency.angular();
  const auto factor = acceleration_factor(reference.description(), name, angular_hz);
  if (factor != acceleration_factor(reference.description(), name, 2.0 * angular_hz)) {
    return std::nullopt;
  }
  const std::vector<double> values = part_of(reference, channel, window, planned.frequency).values;
  if (values.empty()) {
    return std::nullopt;
  }
  double planned_power = 0.0;
  for (std::size_t line = 0; line < recipe.lines_at_once(); ++line) {
    planned_power += 0.5 * recipe.steps[line].level_m_s2 * recipe.steps[line].level_m_s2;
  }
  return ShownLevel{*factor * analysis::standard_deviation(values), std::sqrt(planned_power),
                    fmt::format("{} lines together", recipe.lines_at_once()), "m/s^2 rms"};
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
  const auto level = recipe_.is_multisine()
                         ? rms_of_lines(recipe_, reference, *channel, window, planned)
                         : level_of_step(recipe_, reference, *channel, window, planned);
  if (!level || level->shown_m_s2 <= max_excess * level->planned_m_s2) {
    return std::nullopt;
  }
  return fmt::format("{}: {} shows {:.3g} {} where {:.3g} {} are planned; the excitation is "
                     "stopped. Is generator.level_per_volt right for this exciter, and the gain "
                     "of the amplifier?",
                     level->of, recipe_.reference().text(), level->shown_m_s2, level->unit,
                     level->planned_m_s2, level->unit);
}

} // namespace dyncal::inline evaluation
