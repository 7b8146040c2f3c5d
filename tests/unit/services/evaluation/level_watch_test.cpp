#include "services/evaluation/level_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/evaluation/recipe/recipe_message.hpp"
#include "tests/unit/services/evaluation/feed.hpp"
#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::inline evaluation {
namespace {

using testing::HasSubstr;

// What is said while the step at index `step` is excited, block after block of the ACS.
std::vector<std::string> sentences_while(const tests::SyntheticRun& run, std::size_t step,
                                         const std::string& unit = R"(\metre\second\tothe{-2})") {
  const Recipe recipe = *parse_recipe(run.measurement());
  LevelWatch watch(recipe);
  SourceRecord record("acs");
  wire::SourceDescription description = run.acs_description();
  description.channels()[0].unit(unit);
  record.describe(contract::from_message(description));
  std::vector<std::string> sentences;
  for (const wire::SampleBlock& block : run.acs_blocks()) {
    tests::feed(record, block);
    if (auto sentence = watch.look(record, recipe.steps[step])) {
      sentences.push_back(std::move(*sentence));
    }
  }
  return sentences;
}

TEST(LevelWatch, IsSilentUpToTwiceThePlannedLevel) {
  EXPECT_THAT(sentences_while({.steps = {{"40", 10.0}}}, 0), testing::IsEmpty());
  EXPECT_THAT(sentences_while({.steps = {{"40", 19.9}}}, 0), testing::IsEmpty());
}

TEST(LevelWatch, SaysWhatIsShownAndWhatIsPlanned) {
  const auto sentences = sentences_while({.steps = {{"40", 500.0}}}, 0);
  ASSERT_FALSE(sentences.empty());
  EXPECT_THAT(sentences.front(), HasSubstr("step 1, 40 Hz: acs/reference shows "));
  EXPECT_THAT(sentences.back(), HasSubstr("where 10 m/s^2 are planned"));
  EXPECT_THAT(sentences.back(), HasSubstr("level_per_volt"));
}

TEST(LevelWatch, TakesNoOtherFrequencyForTheStep) {
  EXPECT_THAT(sentences_while({.steps = {{"40", 10.0}, {"400", 500.0}}}, 0), testing::IsEmpty());
}

TEST(LevelWatch, DoesNotCompareWhatIsNoAcceleration) {
  EXPECT_THAT(sentences_while({.steps = {{"40", 500.0}}}, 0, R"(\volt)"), testing::IsEmpty());
}

} // namespace
} // namespace dyncal::inline evaluation
