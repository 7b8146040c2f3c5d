#include "services/views/objections/axis_objections.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/contract/channel_axis.hpp"
#include "services/views/language/objection_sentences.hpp"

namespace dyncal::inline views {
namespace {

// In D-SI or as a quotient of short forms, an angle is named alike.
bool is_of_another_kind(const std::vector<StoredValue>& values) {
  return std::ranges::any_of(
      values, [](const StoredValue& value) { return value.unit.find("rad") != std::string::npos; });
}

bool has_transverse_motion(const StoredPoint& point) {
  return std::ranges::any_of(point.budget, [](const analysis::Contribution& row) {
    return row.kind == analysis::ContributionKind::transverse_motion;
  });
}

// Where the uncertainty lacks what it needs.
bool lacks_transverse_motion(const StoredResult& result, const std::string& channel) {
  const auto points = result.points_of(channel);
  return std::ranges::any_of(points, [](const StoredPoint& point) {
    return point.valid && !has_transverse_motion(point);
  });
}

} // namespace

std::vector<TranslatedText> objections_to_axes(const StoredResult& result,
                                               const std::vector<std::string>& channels) {
  std::vector<TranslatedText> objections;
  std::set<std::string> axes;
  bool is_stated = true;
  for (const std::string& channel : channels) {
    const auto values = result.values_of(channel);
    const std::string axis = axis_of(channel, result.corrections ? result.corrections->channel_axes
                                                                 : std::vector<ChannelAxis>());
    if (values.empty() || axis.empty() || is_of_another_kind(values)) {
      continue;
    }
    axes.insert(axis);
    const std::string& excited = values.front().excited_axis;
    is_stated = is_stated && is_of_x_y_z(excited);
    if (lies_across(axis, excited) && lacks_transverse_motion(result, channel)) {
      objections.push_back(in_all_languages(
          [&](Language language) { return sentences::lies_across(language, channel, excited); }));
    }
  }
  if (!is_stated && axes.size() > 1) {
    objections.push_back(in_all_languages([&](Language language) {
      return sentences::axis_not_stated(language, fmt::join(axes, ", "));
    }));
  }
  return objections;
}

} // namespace dyncal::inline views
