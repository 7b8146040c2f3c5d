#include "services/evaluation/method/shape_check.hpp"

#include <complex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

using testing::HasSubstr;

// A channel whose shape has lost `error` of its amplitude at both peaks, by a narrow cut: odd
// harmonics as large as the loss, in phase for the third, against it for the fifth, and so on.
analysis::SineShape shape(double error) {
  analysis::SineShape made;
  made.order_of_half_rate = 40.0;
  made.periods = 100.0;
  for (int order = 2; order <= 10; ++order) {
    const double sign = order % 4 == 3 ? 1.0 : -1.0;
    made.harmonics.push_back({order, order % 2 == 1 ? sign * error : 0.0, 1e-5});
  }
  return made;
}

analysis::ChannelFit channel(const std::string& name, double error) {
  analysis::ChannelFit made{name, analysis::Frequency::from_hz(20.0), 0.0, 0, {}, {}};
  made.integrity.emplace();
  made.integrity->shape = shape(error);
  return made;
}

StepResult result(double u_magnitude) {
  StepResult made;
  made.valid = true;
  made.unit = R"(\one)";
  made.magnitude = 1.0;
  made.u_magnitude = u_magnitude;
  made.u_phase_rad = 1e-3;
  return made;
}

std::vector<ResultFlag> kinds(const StepResult& of) {
  std::vector<ResultFlag> all;
  for (const Flag& flag : of.flags) {
    all.push_back(flag.kind);
  }
  return all;
}

TEST(ShapeCheck, NamesTheChannelWhosePeaksAreBent) {
  StepResult of_sensor = result(1e-3);
  check_shape(channel("acs/ref", 0.0), false, channel("dau/z", 0.005), of_sensor);
  ASSERT_THAT(kinds(of_sensor), testing::ElementsAre(ResultFlag::peaks_bent));
  EXPECT_THAT(of_sensor.flags[0].sentence, HasSubstr("dau/z"));
  EXPECT_TRUE(of_sensor.valid);
  StepResult of_reference = result(1e-3);
  check_shape(channel("acs/ref", 0.005), false, channel("dau/z", 0.0), of_reference);
  ASSERT_THAT(kinds(of_reference), testing::ElementsAre(ResultFlag::peaks_bent));
  EXPECT_THAT(of_reference.flags[0].sentence, HasSubstr("acs/ref"));
}

// A filter behind the ends turns harmonics, as if the sensor had gained amplitude.
TEST(ShapeCheck, NamesBothWhereTheShapesDoNotTellWhich) {
  StepResult turned = result(1e-3);
  check_shape(channel("acs/ref", 0.0), false, channel("dau/z", -0.02), turned);
  ASSERT_THAT(kinds(turned), testing::ElementsAre(ResultFlag::peaks_bent, ResultFlag::peaks_bent));
  EXPECT_THAT(turned.flags[0].sentence, testing::StartsWith("acs/ref: "));
  EXPECT_THAT(turned.flags[0].sentence, HasSubstr("or those of dau/z"));
  EXPECT_THAT(turned.flags[1].sentence, testing::StartsWith("dau/z: "));
  EXPECT_THAT(turned.flags[1].sentence, HasSubstr("or those of acs/ref"));
  EXPECT_THAT(turned.problem, HasSubstr("the peaks of acs/ref or of dau/z are bent"));
}

TEST(ShapeCheck, SaysNothingWhereUncertaintyCoversItOrBothHaveIt) {
  StepResult covered = result(0.02);
  check_shape(channel("acs/ref", 0.0), false, channel("dau/z", 0.005), covered);
  EXPECT_TRUE(covered.flags.empty());
  StepResult common = result(1e-4);
  check_shape(channel("acs/ref", 0.005), false, channel("dau/z", 0.005), common);
  EXPECT_TRUE(common.flags.empty());
}

TEST(ShapeCheck, RefusesWhatIsBentByMuch) {
  StepResult bent = result(1e-3);
  check_shape(channel("acs/ref", 0.0), false, channel("dau/z", 0.03), bent);
  EXPECT_FALSE(bent.valid);
  EXPECT_THAT(bent.problem, HasSubstr("the peaks of dau/z are bent"));
}

TEST(ShapeCheck, FlagsHeldValuesForTheirHarmonicsAndDoesNotRefuseThem) {
  StepResult held = result(1e-3);
  analysis::ChannelFit sensor = channel("dau/z", 0.05);
  sensor.integrity->repeated_beyond_chance_part = 0.02;
  check_shape(channel("acs/ref", 0.0), false, sensor, held);
  EXPECT_TRUE(held.valid);
  EXPECT_THAT(kinds(held),
              testing::ElementsAre(ResultFlag::values_off_stamps, ResultFlag::peaks_bent));
}

TEST(ShapeCheck, ShotsAreJudgedTogether) {
  std::vector<analysis::SineShape> shots(9, shape(0.004));
  for (analysis::SineShape& shot : shots) {
    for (analysis::ShapeHarmonic& one : shot.harmonics) {
      one.u = 3e-3;
    }
  }
  StepResult alone = result(1e-3);
  check_shape_of_shots(channel("acs/ref", 0.0), false, "tss/z", std::span(shots).first(1), alone);
  EXPECT_TRUE(alone.flags.empty());
  StepResult together = result(1e-3);
  check_shape_of_shots(channel("acs/ref", 0.0), false, "tss/z", shots, together);
  EXPECT_THAT(kinds(together), testing::ElementsAre(ResultFlag::peaks_bent));
}

TEST(ShapeCheck, StampsThatScatterAreFlaggedFromTheUncertaintyOn) {
  analysis::ChannelFit sensor = channel("dau/z", 0.0);
  sensor.scatter = {.shortening_rel = 3e-3, .u_shortening_rel = 1e-5};
  StepResult small = result(5e-3);
  check_shape(channel("acs/ref", 0.0), false, sensor, small);
  EXPECT_TRUE(small.flags.empty());
  StepResult large = result(1e-3);
  check_shape(channel("acs/ref", 0.0), false, sensor, large);
  EXPECT_THAT(kinds(large), testing::ElementsAre(ResultFlag::stamps_scatter));
  sensor.scatter.far_off = 5;
  StepResult few = result(1e-3);
  check_shape(channel("acs/ref", 0.0), false, sensor, few);
  EXPECT_THAT(kinds(few),
              testing::ElementsAre(ResultFlag::values_off_stamps, ResultFlag::stamps_scatter));
}

TEST(ShapeCheck, HeldValuesAndReadBuffersAreSaid) {
  analysis::ChannelFit held = channel("dau/z", 0.0);
  held.integrity->repeated_beyond_chance_part = 0.1;
  StepResult of_held = result(1e-3);
  check_shape(channel("acs/ref", 0.0), false, held, of_held);
  ASSERT_THAT(kinds(of_held), testing::ElementsAre(ResultFlag::values_off_stamps));
  EXPECT_THAT(of_held.flags[0].sentence, HasSubstr("10 % of the values are held"));
  analysis::ChannelFit read = channel("dau/z", 0.0);
  read.scatter.batched_part = 0.875;
  StepResult of_read = result(1e-3);
  check_shape(channel("acs/ref", 0.0), false, read, of_read);
  EXPECT_THAT(kinds(of_read), testing::ElementsAre(ResultFlag::values_off_stamps));
}

TEST(ShapeCheck, ValuesInTurnOfTwoSensorsAreSaidWithTheirDifference) {
  analysis::ChannelFit alternating = channel("dau/z", 0.0);
  alternating.scatter.alternating.certain_rel = 0.025;
  StepResult of_two = result(1e-3);
  check_shape(channel("acs/ref", 0.0), false, alternating, of_two);
  ASSERT_THAT(kinds(of_two), testing::ElementsAre(ResultFlag::values_off_stamps));
  EXPECT_THAT(of_two.flags[0].sentence, HasSubstr("a sine that differs by 5 %"));
}

} // namespace
} // namespace dyncal::inline evaluation
