#include "analysis/uncertainty/monte_carlo.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

double sum(std::span<const double> inputs) {
  double result = 0.0;
  for (const double input : inputs) {
    result += input;
  }
  return result;
}

// Of a model with one output.
Expected<MonteCarloResult> draw(std::span<const InputQuantity> inputs,
                                std::span<const InputCorrelation> correlations,
                                const std::function<double(std::span<const double>)>& model,
                                const MonteCarloSettings& settings = {}) {
  return propagate_distributions(
             inputs, correlations, 1,
             [&](std::span<const double> x, std::span<double> y) { y[0] = model(x); }, settings)
      .map([](const std::vector<MonteCarloResult>& results) { return results.front(); });
}

// JCGM 101, 9.2.2 and 9.2.3: four normal, then four rectangular inputs of unit standard
// uncertainty.
TEST(MonteCarlo, MeetsTheAdditiveModelOfJcgm101) {
  std::vector<InputQuantity> inputs(4, InputQuantity{.name = "x", .u = 1.0});
  const auto normal = draw(inputs, {}, sum, {.probability = 0.95});
  ASSERT_TRUE(normal.has_value());
  EXPECT_NEAR(normal->u, 2.0, 0.04);
  EXPECT_NEAR(normal->low, -3.92, 0.08);
  EXPECT_NEAR(normal->high, 3.92, 0.08);
  EXPECT_TRUE(normal->stable);
  for (InputQuantity& input : inputs) {
    input.distribution = Distribution::rectangular;
  }
  const auto rectangular = draw(inputs, {}, sum, {.probability = 0.95});
  ASSERT_TRUE(rectangular.has_value());
  EXPECT_NEAR(rectangular->u, 2.0, 0.04);
  EXPECT_NEAR(rectangular->high, 3.88, 0.08); // the analytic value of the standard
}

TEST(MonteCarlo, DrawsCorrelatedInputsTogether) {
  const std::array inputs{InputQuantity{.name = "a", .u = 1.0},
                          InputQuantity{.name = "b", .u = 1.0}};
  const std::array correlations{InputCorrelation{0, 1, 0.8}};
  const auto result = draw(inputs, correlations, [](auto x) { return x[0] - x[1]; });
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->u, std::sqrt(2.0 - 1.6), 0.01);
}

TEST(MonteCarlo, FewDegreesOfFreedomGiveTheWiderStudentDistribution) {
  const std::array inputs{InputQuantity{.name = "a", .u = 1.0, .degrees_of_freedom = 5.0}};
  const auto result = draw(inputs, {}, sum);
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->u, std::sqrt(5.0 / 3.0), 0.03);
  EXPECT_NEAR(result->high, coverage_factor(5.0), 0.05);
}

TEST(MonteCarlo, SameSeedGivesTheSameNumbers) {
  const std::array inputs{InputQuantity{.name = "a", .u = 1.0}};
  const auto a = draw(inputs, {}, sum, {.seed = 9, .max_trials = 20'000});
  const auto b = draw(inputs, {}, sum, {.seed = 9, .max_trials = 20'000});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->mean, b->mean);
  EXPECT_EQ(a->trials, 20'000u);
}

TEST(MonteCarlo, EndsSoonAfterItWasAskedToStop) {
  const std::vector<InputQuantity> inputs{{.name = "x", .u = 9.9}};
  std::stop_source stop;
  int trials = 0;
  const auto stopped = draw(inputs, {},
                            [&](std::span<const double> drawn) {
                              if (++trials == 5000) {
                                stop.request_stop();
                              }
                              return drawn[0];
                            },
                            {.stop = stop.get_token()});
  ASSERT_FALSE(stopped.has_value());
  EXPECT_EQ(stopped.error().code, ErrorCode::not_converged);
  EXPECT_EQ(trials, 10'000); // the batch is drawn to its end
}

TEST(MonteCarlo, OutputsShareTheirDraws) {
  const std::array inputs{InputQuantity{.name = "a", .u = 1.0}};
  const auto results = propagate_distributions(inputs, {}, 2,
                                               [](std::span<const double> x, std::span<double> y) {
                                                 y[0] = x[0];
                                                 y[1] = 2.0 * x[0];
                                               },
                                               {.max_trials = 20'000});
  ASSERT_TRUE(results.has_value());
  ASSERT_EQ(results->size(), 2u);
  EXPECT_EQ((*results)[1].high, 2.0 * (*results)[0].high);
  EXPECT_EQ((*results)[0].trials, (*results)[1].trials);
}

TEST(MonteCarlo, SaysWhatItCannotDraw) {
  const std::array inputs{
      InputQuantity{.name = "a", .u = 1.0},
      InputQuantity{.name = "b", .u = 1.0, .distribution = Distribution::rectangular}};
  const std::array correlations{InputCorrelation{0, 1, 0.5}};
  EXPECT_FALSE(draw(inputs, correlations, sum).has_value());
  const std::array zero{InputQuantity{.name = "a", .u = 0.0}};
  EXPECT_EQ(draw(zero, {}, [](auto x) { return 1.0 / x[0]; }).error().code, ErrorCode::not_finite);
}

} // namespace
} // namespace dyncal::analysis
