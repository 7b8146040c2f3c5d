#include "services/views/report/paired_points.hpp"

#include <set>

namespace dyncal::inline views {
namespace {

void keep(const std::string& channel, std::optional<double> level_m_s2, ResultPoints& points) {
  std::erase_if(points, [&](const auto& one) {
    return (!channel.empty() && one.first.channel != channel) ||
           (level_m_s2 && one.first.level_m_s2 != *level_m_s2);
  });
}

std::set<std::string> axes_of(const ResultPoints& points) {
  std::set<std::string> axes;
  for (const auto& [identity, point] : points) {
    axes.insert(identity.axis);
  }
  return axes;
}

// Those of `points` without an axis get the only one of `others`.
std::string assume_axis(ResultPoints& points, const ResultPoints& others) {
  const std::set<std::string> own = axes_of(points);
  const std::set<std::string> other = axes_of(others);
  if (own != std::set<std::string>{""} || other.size() != 1 || other.contains("")) {
    return "";
  }
  ResultPoints named;
  for (const auto& [identity, point] : points) {
    PointIdentity now = identity;
    now.axis = *other.begin();
    named.emplace(std::move(now), point);
  }
  points = std::move(named);
  return *other.begin();
}

std::vector<double> levels_of(const PairedPoints& paired, PointIdentity PointPair::*identity,
                              const std::vector<PointIdentity>& alone) {
  std::set<double> levels;
  for (const PointPair& pair : paired.pairs) {
    levels.insert((pair.*identity).level_m_s2);
  }
  for (const PointIdentity& one : alone) {
    levels.insert(one.level_m_s2);
  }
  return {levels.begin(), levels.end()};
}

} // namespace

PairedPoints pair_points(ResultPoints first, ResultPoints second, const PairingOptions& options) {
  const std::string& second_channel =
      options.second_channel.empty() ? options.first_channel : options.second_channel;
  const auto second_level_m_s2 =
      options.second_level_m_s2 ? options.second_level_m_s2 : options.first_level_m_s2;
  keep(options.first_channel, options.first_level_m_s2, first);
  keep(second_channel, second_level_m_s2, second);
  PairedPoints paired;
  paired.assumed_axis = assume_axis(first, second) + assume_axis(second, first);
  for (const auto& [identity, point] : first) {
    PointIdentity partner = identity;
    partner.channel = second_channel.empty() ? identity.channel : second_channel;
    partner.level_m_s2 = second_level_m_s2.value_or(identity.level_m_s2);
    const auto match = second.lower_bound(partner);
    if (match == second.end() || match->first != partner) {
      paired.only_first.push_back(identity);
      continue;
    }
    paired.pairs.push_back({identity, std::move(partner), point, match->second});
    second.erase(match);
  }
  for (const auto& [identity, point] : second) {
    paired.only_second.push_back(identity);
  }
  return paired;
}

std::vector<double> first_levels_m_s2(const PairedPoints& paired) {
  return levels_of(paired, &PointPair::first_identity, paired.only_first);
}

std::vector<double> second_levels_m_s2(const PairedPoints& paired) {
  return levels_of(paired, &PointPair::second_identity, paired.only_second);
}

} // namespace dyncal::inline views
