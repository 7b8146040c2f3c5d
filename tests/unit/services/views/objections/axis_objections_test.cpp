#include "services/views/objections/axis_objections.hpp"

#include <gmock/gmock.h>

#include "services/views/language/translated_texts.hpp"

namespace dyncal::inline views {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// x and z under calibration, excited along `axis`.
StoredResult result_along(const std::string& axis) {
  StoredResult result;
  for (const char* const channel : {"dau/acceleration_x", "dau/acceleration_z"}) {
    StoredValue value;
    value.channel = channel;
    value.excited_axis = axis;
    value.unit = R"(\one)";
    result.values.push_back(value);
    StoredPoint point;
    point.channel = channel;
    point.valid = true;
    result.points.push_back(point);
  }
  return result;
}

std::vector<std::string> english(const StoredResult& result,
                                 const std::vector<std::string>& channels) {
  return texts_in(Language::english, objections_to_axes(result, channels));
}

void add_motion(StoredPoint& point) {
  point.budget.push_back({.kind = analysis::ContributionKind::transverse_motion});
}

const std::vector<std::string> both{"dau/acceleration_x", "dau/acceleration_z"};

TEST(AxisObjections, NamesAChannelAcrossTheExcitedAxis) {
  StoredResult result = result_along("z");
  EXPECT_THAT(english(result, {"dau/acceleration_z"}), IsEmpty());
  EXPECT_THAT(english(result, both),
              ElementsAre(HasSubstr("dau/acceleration_x lies across the excited axis z")));
  add_motion(result.points.front());
  EXPECT_THAT(english(result, both), IsEmpty());
  result.points.push_back(result.points.front()); // one repetition lacks it
  result.points.back().budget.clear();
  EXPECT_THAT(english(result, both), ElementsAre(HasSubstr("dau/acceleration_x")));
}

// A name that says nothing of the channels is as good as none.
TEST(AxisObjections, AsksForTheExcitedAxisWhereChannelsHaveSeveral) {
  EXPECT_THAT(english(result_along("vertical"), both),
              ElementsAre(HasSubstr("channels along x, z are named")));
  EXPECT_THAT(english(result_along("vertical"), {"dau/acceleration_z"}), IsEmpty());
  const StoredResult result = result_along("");
  EXPECT_THAT(english(result, both), ElementsAre(HasSubstr("channels along x, z are named")));
  EXPECT_THAT(english(result, {"dau/acceleration_x"}), IsEmpty());
}

TEST(AxisObjections, SaysNothingOfAnotherKind) {
  StoredResult result = result_along("z");
  result.values.front().unit = R"(\radian\second\tothe{-1}\metre\tothe{-1}\second\tothe{2})";
  EXPECT_THAT(english(result, both), IsEmpty());
}

} // namespace
} // namespace dyncal::inline views
