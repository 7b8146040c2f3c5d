#include "services/evaluation/method/line_check.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

using analysis::LineKind;

Recipe recipe_of(const std::vector<std::string>& frequencies) {
  Recipe recipe;
  for (const std::string& text : frequencies) {
    recipe.steps.push_back(
        {.frequency_text_hz = text, .frequency = analysis::Frequency::parse(text).value()});
  }
  return recipe;
}

// Two seconds at 1 kS/s: a sine of 10, its second harmonic of 0.1, hum of 0.02 at 50 Hz.
ChannelLines lines_of(const Recipe& recipe, double frequency_hz) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  for (int i = 0; i < 2000; ++i) {
    const double turn = 2e-3 * std::numbers::pi * i;
    stamps_ns.push_back(1'000'000LL * i);
    values.push_back(10.0 * std::sin(frequency_hz * turn) +
                     0.1 * std::sin(2.0 * frequency_hz * turn) +
                     0.02 * std::sin(50.0 * turn + 1.0) + noise(random));
  }
  const std::span<const double> channel[] = {values};
  const auto frequency = analysis::Frequency::from_hz(frequency_hz);
  const auto fit = analysis::fit_sine(frequency, 0, stamps_ns, channel);
  return check_lines(recipe, {"the sensor"},
                     {.channel = "dau/z", .frequency = frequency, .fit = fit->front()}, stamps_ns,
                     values);
}

TEST(LineCheck, MeasuresOnlyWhatAStepOfTheRecipeNeeds) {
  EXPECT_TRUE(lines_of(recipe_of({"80", "160"}), 80.0).measured.empty()); // a harmonic
  const ChannelLines lines = lines_of(recipe_of({"80", "50.1"}), 80.0);
  EXPECT_TRUE(lines.unresolved.empty());
  ASSERT_EQ(lines.measured.size(), 3U); // 50 Hz and its kindred, and what else is at 50.1 Hz
  EXPECT_EQ(lines.measured[1].line_hz, 150.0);
  EXPECT_EQ(lines.measured[2].kind, LineKind::background);
  EXPECT_EQ(lines.measured[2].line_hz, 50.1);
  EXPECT_EQ(lines.measured[0].kind, LineKind::mains);
  EXPECT_NEAR(lines.measured[0].measured.amplitude, 0.02,
              4.0 * lines.measured[0].measured.u_component);
  EXPECT_NEAR(lines.amplitude, 10.0, 0.01);
}

// Of whatever kind it is: here at the frequency of another step, beside no line of the mains.
TEST(LineCheck, MeasuresTheBackgroundAtTheFrequenciesOfOtherSteps) {
  const ChannelLines lines = lines_of(recipe_of({"80", "63"}), 80.0);
  ASSERT_EQ(lines.measured.size(), 1U);
  EXPECT_EQ(lines.measured[0].kind, LineKind::background);
  EXPECT_EQ(lines.measured[0].line_hz, 63.0);
  EXPECT_LT(lines.measured[0].measured.amplitude, 6.0 * lines.measured[0].measured.u_component);
  EXPECT_EQ(lines.frequency_hz, 80.0);
}

TEST(LineCheck, HarmonicsArePartsOfTheAmplitude) {
  const ChannelLines lines = lines_of(recipe_of({"80", "333.4"}), 80.0); // 2 f folds onto it
  ASSERT_FALSE(lines.measured.empty());
  EXPECT_EQ(lines.measured[0].kind, LineKind::harmonic);
  EXPECT_EQ(lines.measured[0].order, 2);
  EXPECT_NEAR(lines.measured[0].measured.amplitude, 0.01, 1e-4);
}

TEST(LineCheck, AStepBesideALineTellsNothingOfIt) {
  const ChannelLines lines = lines_of(recipe_of({"80", "50.1"}), 50.1);
  ASSERT_EQ(lines.unresolved.size(), 1U);
  EXPECT_EQ(lines.unresolved[0].line_hz, 50.0);
  for (const MeasuredLine& line : lines.measured) {
    EXPECT_NE(line.kind, LineKind::mains); // nor of 150 Hz, beside the third harmonic
  }
}

TEST(LineCheck, AResultWithSuchALineIsProvisional) {
  StepResult far, beside, refused;
  far.valid = beside.valid = true;
  add_lines({lines_of(recipe_of({"80"}), 80.0)}, far);
  EXPECT_FALSE(far.provisional);
  add_lines({lines_of(recipe_of({"50.1"}), 50.1)}, beside);
  EXPECT_TRUE(beside.provisional);
  EXPECT_THAT(sentences_of(beside.flags),
              testing::ElementsAre("dau/z: hum at 50 Hz cannot be told from the excitation"));
  add_lines({lines_of(recipe_of({"50.1"}), 50.1)}, refused); // has no number to bound
  EXPECT_FALSE(refused.provisional);
  EXPECT_TRUE(refused.flags.empty());
}

} // namespace
} // namespace dyncal::inline evaluation
