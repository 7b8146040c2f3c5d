#include "services/evaluation/record/excitation_survey.hpp"

#include <gtest/gtest.h>

#include "services/contract/source_block.hpp"
#include "services/contract/source_description.hpp"
#include "services/evaluation/recipe/recipe_message.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

// All steps last from 0.5 s on for 1.5 s, every 2 s.
RecordedExcitations survey(const tests::SyntheticRun& run, const tests::SyntheticRun& planned,
                           std::size_t first_block = 0) {
  const Recipe recipe = *parse_recipe(planned.measurement());
  ExcitationSurvey survey({"acs", "sync"}, "reference", recipe);
  survey.describe(from_message(run.acs_description()));
  const auto blocks = run.acs_blocks();
  for (std::size_t i = first_block; i < blocks.size(); ++i) {
    survey.add(view_block(blocks[i]));
  }
  return survey.result();
}

TEST(ExcitationSurvey, FindsAllThatIsThereInWhateverOrder) {
  const tests::SyntheticRun planned{.steps = {{"40"}, {"80"}, {"40"}}};
  const tests::SyntheticRun run{.steps = {{"80", 5.0}, {"40"}, {"40", 0.0}, {"80"}}};
  const RecordedExcitations record = survey(run, planned);
  EXPECT_EQ(record.channel, "acs/sync");
  ASSERT_EQ(record.found.size(), 3U);
  const double begins_s[] = {0.5, 2.5, 6.5};
  const double frequencies_hz[] = {80.0, 40.0, 80.0};
  const double levels_m_s2[] = {5.0, 10.0, 10.0};
  for (std::size_t i = 0; i < 3; ++i) {
    const FoundExcitation& found = record.found[i];
    EXPECT_NEAR(static_cast<double>(found.begin_ns()) * 1e-9, begins_s[i], 0.15);
    EXPECT_NEAR(static_cast<double>(found.end_ns()) * 1e-9, begins_s[i] + 1.5, 0.15);
    EXPECT_NEAR(found.window.frequency_hz, frequencies_hz[i], 1e-3);
    ASSERT_TRUE(found.level_m_s2);
    EXPECT_NEAR(*found.level_m_s2, levels_m_s2[i], 0.01);
  }
  EXPECT_EQ(record.recorded.begin_ns, 0);
  EXPECT_NEAR(static_cast<double>(record.recorded.end_ns) * 1e-9, 8.5, 1e-3);
  EXPECT_TRUE(record.holes.empty());
}

TEST(ExcitationSurvey, TellsFrequenciesThatLieCloseTogetherApart) {
  const tests::SyntheticRun planned{.steps = {{"80.00"}, {"80.02"}}};
  const tests::SyntheticRun run{.steps = {{"80.02"}, {"80.00"}, {"80.02"}}};
  const RecordedExcitations record = survey(run, planned);
  ASSERT_EQ(record.found.size(), 3U);
  EXPECT_NEAR(record.found[0].window.frequency_hz, 80.02, 2e-3);
  EXPECT_NEAR(record.found[1].window.frequency_hz, 80.00, 2e-3);
}

TEST(ExcitationSurvey, ARecordMayBeginWithinAStep) {
  const tests::SyntheticRun run{.steps = {{"40"}, {"80"}}};
  const std::size_t block = 20; // of 50 ms
  const RecordedExcitations record = survey(run, run, block);
  ASSERT_EQ(record.found.size(), 2U);
  EXPECT_EQ(record.recorded.begin_ns, 1'000'000'000);
  EXPECT_GE(record.found[0].begin_ns(), 1'000'000'000);
  EXPECT_LT(record.found[0].begin_ns(), 1'100'000'000);
}

} // namespace
} // namespace dyncal::inline evaluation
