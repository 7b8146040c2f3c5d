#include "services/evaluation/method/unstated_uncertainty.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Recipe stated() {
  Recipe recipe;
  recipe.adc_calibration = {{.frequency_hz = 10.0}};
  recipe.systematic.reference_magnitude_rel = 1e-3;
  recipe.systematic.reference_phase_rad = 1e-3;
  recipe.systematic.acs_delay_s = 1e-7;
  return recipe;
}

std::vector<ResultFlag> kinds(const Recipe& recipe) {
  std::vector<ResultFlag> kinds;
  for (const Flag& flag : flags_of_unstated(recipe)) {
    kinds.push_back(flag.kind);
  }
  return kinds;
}

TEST(UnstatedUncertainty, NothingIsSaidWhereAllIsStated) {
  EXPECT_THAT(kinds(stated()), IsEmpty());
}

TEST(UnstatedUncertainty, OfTheReferenceMagnitudeAndPhaseAreNeeded) {
  Recipe recipe = stated();
  recipe.systematic.reference_phase_rad = 0.0;
  EXPECT_THAT(kinds(recipe), ElementsAre(ResultFlag::reference_uncertainty_not_stated));
  recipe = stated();
  recipe.systematic.reference_magnitude_rel = 0.0;
  EXPECT_THAT(sentences_of(flags_of_unstated(recipe)),
              ElementsAre("the uncertainty of the reference is not stated"));
}

TEST(UnstatedUncertainty, TheCalibrationOfTheReferenceStatesIt) {
  Recipe recipe = stated();
  recipe.systematic = {};
  recipe.systematic.acs_delay_s = 1e-7;
  recipe.reference_calibration = {{.frequency_hz = 10.0}};
  EXPECT_THAT(kinds(recipe), ElementsAre(ResultFlag::reference_uncertainty_not_stated));
  recipe.reference_calibration.front().contributions = {
      {.name = "drift", .u_magnitude_rel = 1e-3, .u_phase_rad = 1e-3}};
  EXPECT_THAT(kinds(recipe), IsEmpty());
}

TEST(UnstatedUncertainty, AnAdcIsCalibratedOrItsDelayIsBounded) {
  Recipe recipe = stated();
  recipe.adc_calibration.clear();
  EXPECT_THAT(kinds(recipe), ElementsAre(ResultFlag::adc_not_calibrated));
  recipe.u_adc_delay_s = 1e-6;
  EXPECT_THAT(kinds(recipe), IsEmpty());
  recipe.roles.method = EvaluationMethod::analogue;
  EXPECT_THAT(kinds(recipe), IsEmpty());
}

TEST(UnstatedUncertainty, OfTheTriggerOfAnOscilloscope) {
  Recipe recipe = stated();
  recipe.roles.method = EvaluationMethod::series_timestamping;
  EXPECT_THAT(kinds(recipe), ElementsAre(ResultFlag::trigger_delay_not_stated));
  recipe.series.dso_delay_s = 236e-9; // without its uncertainty
  EXPECT_THAT(kinds(recipe), ElementsAre(ResultFlag::trigger_delay_not_stated));
  recipe.series.u_dso_delay_s = 1e-9;
  EXPECT_THAT(kinds(recipe), IsEmpty());
}

TEST(UnstatedUncertainty, OfTheDelayBetweenChannelsOfTheAcsWhereOneIsComparedWithAnother) {
  Recipe recipe = stated();
  recipe.systematic.acs_delay_s = 0.0;
  EXPECT_THAT(kinds(recipe), ElementsAre(ResultFlag::acs_delay_not_stated));
  recipe.roles.method = EvaluationMethod::analogue;
  EXPECT_THAT(kinds(recipe), ElementsAre(ResultFlag::acs_delay_not_stated));
  recipe.roles.method = EvaluationMethod::absolute_time;
  EXPECT_THAT(kinds(recipe), IsEmpty());
}

} // namespace
} // namespace dyncal::inline evaluation
