// Which points the line through the phases takes whose slope is the group delay: one a frequency,
// of the level that most frequencies have, and of several such levels the highest.
//
// For means of any type, ascending in frequency. Templates, any thread.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace dyncal::inline evaluation {

// By their place; ascending in frequency.
[[nodiscard]] std::vector<std::size_t> delay_points(const auto& points) {
  std::map<double, std::size_t> frequencies_of; // by level
  for (const auto& point : points) {
    ++frequencies_of[point.level_m_s2];
  }
  const auto rank = [&](std::size_t i) {
    const double level = points[i].level_m_s2;
    return std::pair(frequencies_of[level], level);
  };
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (chosen.empty() || points[i].frequency_hz > points[chosen.back()].frequency_hz) {
      chosen.push_back(i);
    } else if (rank(i) > rank(chosen.back())) {
      chosen.back() = i;
    }
  }
  return chosen;
}

// The levels of those; empty where all points are taken.
[[nodiscard]] std::set<double> delay_levels_m_s2(const auto& points) {
  std::set<double> levels;
  const std::vector<std::size_t> chosen = delay_points(points);
  for (const std::size_t i : chosen) {
    levels.insert(points[i].level_m_s2);
  }
  return chosen.size() == points.size() ? std::set<double>{} : levels;
}

} // namespace dyncal::inline evaluation
