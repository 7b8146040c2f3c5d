#include "services/views/objections/objections.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

namespace dyncal::inline views {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const std::string channel = "dau/acceleration_z";

StoredValue value_at(const std::string& frequency) {
  StoredValue value;
  value.channel = channel;
  value.frequency_text_hz = frequency;
  value.frequency_hz = std::stod(frequency);
  value.magnitude = 1.0;
  value.of_magnitude = {.u = 0.001, .k = 2.0, .expanded = 0.002};
  value.of_phase = {.u = 0.001, .k = 2.0, .expanded = 0.002};
  value.coverage_probability = 0.9545;
  value.unit = R"(\one)";
  return value;
}

StoredPoint point_at(const std::string& frequency, unsigned step) {
  StoredPoint point;
  point.channel = channel;
  point.frequency_text_hz = frequency;
  point.frequency_hz = std::stod(frequency);
  point.step = step;
  point.repetition = 1;
  point.valid = true;
  return point;
}

StoredResult whole_run() {
  StoredResult result;
  result.planned_steps = 2;
  result.channels.push_back({channel, R"(\one)", true, 0, {}, {}, {}});
  result.values = {value_at("10"), value_at("20")};
  result.points = {point_at("10", 1), point_at("20", 2)};
  return result;
}

TEST(Objections, NoneToAWholeRun) {
  EXPECT_THAT(objections_to(whole_run(), {channel}), IsEmpty());
  EXPECT_THAT(stated_flags(whole_run(), {channel}), IsEmpty());
}

TEST(Objections, ToLossThatNothingExplains) {
  StoredResult result = whole_run();
  result.points[1].lost = 7;
  EXPECT_THAT(objections_to(result, {channel}),
              ElementsAre(HasSubstr("at 20 Hz, repetition 1: 7 samples were lost")));
  result.points[1].flag_names = {"shots_missing"};
  EXPECT_THAT(objections_to(result, {channel}), IsEmpty());
  result.points[1].flag_names = {"samples_lost"};
  EXPECT_THAT(objections_to(result, {channel}), ElementsAre(HasSubstr("flag samples_lost")));
}

TEST(Objections, ToFlagsOfValuesResultsAndChannels) {
  StoredResult result = whole_run();
  result.values[0].flag_names = {"over_range"};
  result.points[1].flag_names = {"over_range", "shots_missing"};
  EXPECT_THAT(objections_to(result, {channel}),
              ElementsAre(HasSubstr("at 10 Hz, 20 Hz: flag over_range")));
  EXPECT_THAT(stated_flags(result, {channel}),
              ElementsAre(Field(&TranslatedText::english, HasSubstr("shots_missing"))));
  result.channels[0].flag_names = {"over_range"};
  EXPECT_THAT(objections_to(result, {channel}), ElementsAre(HasSubstr("at all frequencies")));
  EXPECT_THAT(objections_to(result, {"dau/other"}), SizeIs(1)); // which has no value at all
}

// A result of `dyncal run` on that bench says when the check was, or why it was left out.
TEST(Objections, ToAResultWithoutTheCheckThatItsBenchDemands) {
  StoredResult result = whole_run();
  result.recipe = "bench = \"b\"\n[check]\nsensor = \"SN-1\"\nmax_age_h = 24\n";
  EXPECT_THAT(objections_to(result, {channel}),
              ElementsAre(HasSubstr("demands a check with sensor 'SN-1'")));
  result.check = DailyCheck{
      .sensor = "SN-1", .run = {}, .began_utc = {}, .state = {}, .left_out = "it is away"};
  EXPECT_THAT(objections_to(result, {channel}), IsEmpty());
}

TEST(Objections, ToRunsThatAreNotWhole) {
  StoredResult result = whole_run();
  result.interrupted = true;
  result.problem = "the cable was pulled";
  result.points[1].valid = false;
  result.points[1].problem = "no steady sine";
  result.values[1].of_phase.expanded = 0.0;
  EXPECT_THAT(objections_to(result, {channel}),
              ElementsAre("the run was interrupted", HasSubstr("the cable was pulled"),
                          HasSubstr("no steady sine"), HasSubstr("1 of 2 planned steps"),
                          HasSubstr("20 Hz: the result has no value with a usable U")));
}

} // namespace
} // namespace dyncal::inline views
