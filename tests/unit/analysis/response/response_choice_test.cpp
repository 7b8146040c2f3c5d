#include "analysis/response/response_choice.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/analysis/response/measured_response.hpp"

namespace dyncal::analysis {
namespace {

using tests::measured_response;

struct Sensor {
  ResponseKind kind;
  ResponseParameters truth;
};

const std::vector<Sensor> sensors{
    {ResponseKind::gain, {.gain = -0.4}},
    {ResponseKind::delay, {.gain = 1.1, .delay_s = 8.1e-3}},
    {ResponseKind::first_order, {.gain = 1.0, .corner_hz = 300.0}},
    {ResponseKind::first_order_with_delay, {.gain = 1.0, .delay_s = 1e-3, .corner_hz = 300.0}},
    {ResponseKind::second_order, {.gain = 2.0, .resonance_hz = 800.0, .damping = 0.05}},
    {ResponseKind::second_order_with_delay, tests::mems_sensor},
    {ResponseKind::second_and_first_order_with_delay,
     {.gain = 1.0, .delay_s = 2e-3, .corner_hz = 150.0, .resonance_hz = 220.0, .damping = 0.4}}};

// One of a hundred tests against each richer kind calls chance a parameter.
TEST(ResponseChoice, FindsTheOrderOfTheSensor) {
  constexpr int runs = 15;
  for (const Sensor& sensor : sensors) {
    int right = 0;
    for (unsigned seed = 1; seed <= runs; ++seed) {
      const auto choice = choose_response(measured_response(sensor.truth, 5e-4, seed));
      ASSERT_TRUE(choice.has_value()) << choice.error().message;
      EXPECT_EQ(choice->candidates.size(), all_response_kinds.size());
      right += choice->best().kind == sensor.kind && choice->fits;
    }
    EXPECT_GE(right, 13) << name_of(sensor.kind);
  }
}

TEST(ResponseChoice, SaysByHowMuchTheOthersAreWorse) {
  const auto choice = choose_response(measured_response(tests::mems_sensor, 5e-4, 3));
  ASSERT_TRUE(choice.has_value());
  ASSERT_TRUE(choice->simpler && choice->richer);
  EXPECT_GT(choice->simpler->chi_squared_gain, 100.0);
  EXPECT_LT(choice->simpler->probability, 1e-10);
  EXPECT_EQ(choice->richer->kind, ResponseKind::second_and_first_order_with_delay);
  EXPECT_GT(choice->richer->probability, 0.01);
  const ResponseCandidate& best = choice->best();
  EXPECT_DOUBLE_EQ(best.aic, best.fit->chi_squared + 8.0);
  EXPECT_DOUBLE_EQ(best.bic, best.fit->chi_squared + 4.0 * std::log(34.0));
}

TEST(ResponseChoice, SaysWhenNoKindFits) {
  auto points = measured_response(tests::mems_sensor, 5e-4, 3);
  points[4].h *= 1.01; // 20 u
  const auto choice = choose_response(points);
  ASSERT_TRUE(choice.has_value());
  EXPECT_FALSE(choice->fits);
  EXPECT_LT(choice->best().probability, 1e-10);
}

// What all points have in common is no evidence: 5 us of the reference look like a delay.
TEST(ResponseChoice, DoesNotTakeACommonErrorForADelay) {
  const ResponseParameters truth{.gain = 1.0};
  const CommonResponseUncertainty common{.gain_rel = 1e-3, .delay_s = 5e-6, .phase_rad = 0.0};
  int wrong = 0, wrong_without = 0;
  for (unsigned seed = 1; seed <= 25; ++seed) {
    const auto points = measured_response(truth, 1e-4, seed, tests::third_octaves, common);
    const auto stated = choose_response(points, common);
    const auto not_stated = choose_response(points);
    ASSERT_TRUE(stated && not_stated);
    wrong += stated->best().kind != ResponseKind::gain;
    wrong_without += not_stated->best().kind != ResponseKind::gain;
  }
  EXPECT_LE(wrong, 2);
  EXPECT_GE(wrong_without, 18);
}

TEST(ResponseChoice, LeavesOutWhatHasMoreParametersThanValues) {
  const auto choice =
      choose_response(measured_response({.gain = 1.0}, 1e-3, 0, std::vector<double>{80, 160}));
  ASSERT_TRUE(choice.has_value()) << choice.error().message;
  EXPECT_EQ(choice->best().kind, ResponseKind::gain);
  EXPECT_NE(choice->candidates.back().problem.find("needs more frequencies than 2"),
            std::string::npos);
  EXPECT_FALSE(choose_response({}).has_value());
}

} // namespace
} // namespace dyncal::analysis
