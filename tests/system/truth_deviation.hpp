// How far a live result is from what the virtual bench knows to be true.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace dyncal::tests {

// Of magnitude and phase of one point, the larger, in standard uncertainties. Infinite where
// `truth` has no such frequency of the channel.
inline double deviation_of_point(const nlohmann::json& point, const nlohmann::json& truth,
                                 const std::string& channel) {
  for (const nlohmann::json& expected : truth["transfer_function"]) {
    if (expected["channel"] == channel && expected["frequency_hz"] == point["frequency_hz"]) {
      const double magnitude =
          point["magnitude"].get<double>() - expected["magnitude"].get<double>();
      const double phase =
          std::remainder(point["phase_rad"].get<double>() - expected["phase_rad"].get<double>(),
                         2.0 * std::numbers::pi);
      return std::max(std::abs(magnitude) / point["u_magnitude"].get<double>(),
                      std::abs(phase) / point["u_phase_rad"].get<double>());
    }
  }
  return std::numeric_limits<double>::infinity();
}

// How many points a live run has of an axis of its sensor: each valid, and within so many standard
// uncertainties of the truth.
inline int points_near_truth(const nlohmann::json& result, const nlohmann::json& truth,
                             const std::string& axis, double uncertainties) {
  int count = 0;
  for (const nlohmann::json& point : result["points"]) {
    if (point["channel"] == "dau/" + axis) {
      EXPECT_TRUE(point["valid"].get<bool>()) << point.dump();
      EXPECT_LT(deviation_of_point(point, truth, axis), uncertainties) << point.dump();
      ++count;
    }
  }
  return count;
}

} // namespace dyncal::tests
