#include "services/evaluation/level_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/sine/schroeder_phases.hpp"
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

// Lines of 10 m/s^2 each with Schroeder's phases, in blocks of half a second.
class MultisineLevel : public testing::Test {
protected:
  static constexpr double period_s = 10.0;
  static constexpr std::size_t rate_hz = 2000;
  const std::vector<std::string> lines_hz_{"20.3", "25.3", "31.3", "39.7", "49.1", "63.1", "80.3"};

  Recipe recipe() const {
    Recipe recipe;
    recipe.roles.reference = {"acs", "reference"};
    recipe.multisine_period_s = period_s;
    for (const std::string& text : lines_hz_) {
      recipe.steps.push_back({.step = static_cast<std::uint32_t>(recipe.steps.size() + 1),
                              .repetition = 1,
                              .frequency_text_hz = text,
                              .frequency = *analysis::Frequency::parse(text),
                              .level_m_s2 = 10.0});
    }
    return recipe;
  }

  // What is said while the exciter gives so many times the levels.
  std::vector<std::string> sentences_at(double times,
                                        const std::string& unit = R"(\metre\second\tothe{-2})") {
    const Recipe planned = recipe();
    LevelWatch watch(planned);
    SourceRecord record("acs");
    drivers::SourceDescription description;
    description.channels = {{.name = "reference", .quantity = "", .unit = unit}};
    record.describe(description);
    const std::vector<double> amplitudes(lines_hz_.size(), 10.0 * times);
    const auto phases = analysis::schroeder_phases(amplitudes);
    std::vector<analysis::MultisineLine> lines;
    for (std::size_t i = 0; i < phases.size(); ++i) {
      lines.push_back({planned.steps[i].frequency.hz(), amplitudes[i], phases[i]});
    }
    const auto waveform =
        analysis::multisine_waveform(lines, period_s, rate_hz * static_cast<std::size_t>(period_s));
    std::vector<std::string> sentences;
    wire::SampleBlock block;
    block.session(1);
    block.interval_numerator_ns(1'000'000'000);
    block.interval_denominator(rate_hz);
    block.channel_count(1);
    block.sample_count(rate_hz / 2);
    for (std::size_t begin = 0; begin < waveform.size(); begin += rate_hz / 2) {
      block.first_sample(begin);
      const auto from = waveform.begin() + static_cast<std::ptrdiff_t>(begin);
      block.values().assign(from, from + rate_hz / 2);
      tests::feed(record, block);
      block.block(block.block() + 1);
      if (auto sentence = watch.look(record, planned.steps.front())) {
        sentences.push_back(std::move(*sentence));
      }
    }
    return sentences;
  }
};

TEST_F(MultisineLevel, IsThatOfAllLinesWhereverTheWindowLies) {
  EXPECT_THAT(sentences_at(1.0), testing::IsEmpty());
  EXPECT_THAT(sentences_at(1.7), testing::IsEmpty());
  const auto sentences = sentences_at(2.3);
  ASSERT_GT(sentences.size(), 10U); // of twenty windows
  EXPECT_THAT(sentences.front(), HasSubstr("7 lines together: acs/reference shows "));
  EXPECT_THAT(sentences.front(), HasSubstr("where 18.7 m/s^2 rms are planned"));
}

TEST_F(MultisineLevel, IsNotJudgedInAnotherQuantity) {
  EXPECT_THAT(sentences_at(50.0, R"(\metre)"), testing::IsEmpty());
}

} // namespace
} // namespace dyncal::inline evaluation
