// The points of two results in pairs, and those without a partner.
//
// Partners have channel, frequency, level, axis and repetition in common, but for what the options
// choose otherwise. Where all points of one result have no axis and the other has a single one,
// they are taken for those of that axis: `assumed_axis` says so. Plain functions, any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/views/report/result_file.hpp"

namespace dyncal::inline views {

struct PairingOptions {
  std::string first_channel{};               // empty: every channel by its own name
  std::string second_channel{};              // empty: the same as first_channel
  std::optional<double> first_level_m_s2{};  // nothing: every level
  std::optional<double> second_level_m_s2{}; // nothing: the same as first_level_m_s2
};

struct PointPair {
  PointIdentity first_identity;
  PointIdentity second_identity;
  ResultPoint first;
  ResultPoint second;
};

struct PairedPoints {
  std::vector<PointPair> pairs;
  std::vector<PointIdentity> only_first;
  std::vector<PointIdentity> only_second;
  std::string assumed_axis{};
};

[[nodiscard]] PairedPoints pair_points(ResultPoints first, ResultPoints second,
                                       const PairingOptions& options);

// Ascending: of pairs and of points without a partner.
[[nodiscard]] std::vector<double> first_levels_m_s2(const PairedPoints& paired);
[[nodiscard]] std::vector<double> second_levels_m_s2(const PairedPoints& paired);

} // namespace dyncal::inline views
