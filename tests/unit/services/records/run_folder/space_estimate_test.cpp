#include "services/records/run_folder/space_estimate.hpp"

#include <gtest/gtest.h>

#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline records {
namespace {

// 10 steps of 1 s settling and 7 s, each with 2 s around it: 100 s.
RunOutcome planned(double nominal_rate_hz, std::size_t channels) {
  RunOutcome outcome = tests::example_outcome();
  outcome.recipe = tests::example_recipe();
  RecipeStep step = outcome.recipe->steps.at(0);
  step.settling_s = 1.0;
  step.duration_s = 7.0;
  outcome.recipe->steps.assign(10, step);
  RunSource source;
  source.source = "acs";
  source.kind = SourceKind::acs;
  source.description.nominal_rate_hz = nominal_rate_hz;
  source.description.channels.resize(channels);
  outcome.sources = {source};
  return outcome;
}

TEST(SpaceEstimate, FollowsFromPlanRateAndChannels) {
  const SpaceEstimate need = estimate_space(planned(50'000.0, 2), {}, {}, true);
  EXPECT_NEAR(static_cast<double>(need.recording_bytes), 1.2 * 50'000.0 * (2 * 8 + 13) * 100.0,
              1.0);
  EXPECT_GE(need.results_bytes, 10U * 2 * 16'000 * 2 + 16'000'000);
}

TEST(SpaceEstimate, TakesTheMeasuredRateWhereNoneIsStated) {
  const auto measured = estimate_space(planned(0.0, 3), {}, {{"acs", 1000.0}}, true);
  EXPECT_NEAR(static_cast<double>(measured.recording_bytes), 1.2 * 1000.0 * 37 * 100.0, 1.0);
  const auto unknown = estimate_space(planned(0.0, 3), {}, {{"acs", 0.0}}, true);
  EXPECT_NEAR(static_cast<double>(unknown.recording_bytes), 1.2 * 10'000.0 * 37 * 100.0, 1.0);
}

TEST(SpaceEstimate, IsOfResultsAloneWithoutARecording) {
  const SpaceEstimate need = estimate_space(planned(50'000.0, 2), {}, {}, false);
  EXPECT_EQ(need.recording_bytes, 0U);
  EXPECT_EQ(need.bytes(), need.results_bytes);
}

TEST(SizeText, HasAUnitThatFits) {
  EXPECT_EQ(size_text(1'340'000'000), "1.3 GB");
  EXPECT_EQ(size_text(16'640'000), "16.6 MB");
  EXPECT_EQ(size_text(2'400), "2 kB");
}

} // namespace
} // namespace dyncal::inline records
