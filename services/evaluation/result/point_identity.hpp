// Which point of a run a value is of: the channel that answered, and what it was excited with.
//
// Frequency and level are those that were asked for, not what was measured, so that a point is the
// same in every run of a recipe. Several levels at a frequency are several points. A mean over
// repetitions has repetition and attempt 0. Ordered by channel, frequency, level, axis, repetition,
// attempt. Plain data and functions; any thread.
#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "services/evaluation/result/step_result.hpp"
#include "services/evaluation/result/transfer_function.hpp"

namespace dyncal::inline evaluation {

struct PointIdentity {
  std::string channel{};
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0;      // 0: not known
  std::string axis{};           // excited; empty: not stated
  std::uint32_t repetition = 0; // 0: mean over all
  std::uint32_t attempt = 0;    // the excitation of the step; 0: of a mean

  // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 finds a 0 in what is generated
  auto operator<=>(const PointIdentity&) const = default;
};

[[nodiscard]] PointIdentity identity_of(const StepResult& result);
[[nodiscard]] PointIdentity identity_of(const TransferFunction& function,
                                        const FrequencyPoint& point);
// The mean that a single result goes into.
[[nodiscard]] PointIdentity mean_identity_of(const StepResult& result);

// What tells points apart beyond channel and frequency: tables leave out what is the same in all.
struct PointDifferences {
  bool levels = true;
  bool axes = true;
};
[[nodiscard]] PointDifferences differences_of(const std::vector<PointIdentity>& points);

// Whether points, of any type with a level, have more than one.
[[nodiscard]] bool have_several_levels(const auto& points) {
  return std::any_of(points.begin(), points.end(),
                     [&](const auto& one) { return one.level_m_s2 != points.front().level_m_s2; });
}

// "80 Hz, 10 m/s^2, axis z, repetition 2, attempt 3"; what is not known or not to be shown is left
// out, and so is the first attempt.
[[nodiscard]] std::string place_text(const PointIdentity& point, PointDifferences shown = {});
// "dau/x at 80 Hz, 10 m/s^2".
[[nodiscard]] std::string to_string(const PointIdentity& point, PointDifferences shown = {});

} // namespace dyncal::inline evaluation
