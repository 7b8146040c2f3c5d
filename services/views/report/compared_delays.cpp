#include "services/views/report/compared_delays.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace dyncal::inline views {
namespace {

bool has_point_of(const std::string& channel, const std::vector<PointIdentity>& points) {
  return std::ranges::any_of(points, [&](const auto& one) { return one.channel == channel; });
}

// Nothing where the phases are on no line, or on that of another delay as well.
const analysis::GroupDelay* only_delay_of(const StoredResult& result, const std::string& channel) {
  for (const StoredChannel& one : result.channels) {
    if (one.channel == channel && std::ranges::any_of(one.flag_names, [](const auto& flag) {
          return flag == "group_delay_ambiguous" || flag == "group_delay_not_constant";
        })) {
      return nullptr;
    }
  }
  return result.group_delay_of(channel);
}

} // namespace

std::vector<ComparedDelay> compare_delays(const StoredResult& first, const StoredResult& second,
                                          const PairedPoints& paired) {
  std::set<std::pair<std::string, std::string>> channels;
  for (const PointPair& pair : paired.pairs) {
    channels.emplace(pair.first_identity.channel, pair.second_identity.channel);
  }
  std::vector<ComparedDelay> delays;
  for (const auto& [channel, other_channel] : channels) {
    if (has_point_of(channel, paired.only_first) ||
        has_point_of(other_channel, paired.only_second)) {
      continue;
    }
    const analysis::GroupDelay* a = only_delay_of(first, channel);
    const analysis::GroupDelay* b = only_delay_of(second, other_channel);
    if (a == nullptr || b == nullptr) {
      continue;
    }
    if (const auto difference =
            analysis::difference_of(a->delay_s, a->of_delay, b->delay_s, b->of_delay)) {
      delays.push_back({channel, other_channel, a->delay_s, b->delay_s, *difference});
    }
  }
  return delays;
}

} // namespace dyncal::inline views
