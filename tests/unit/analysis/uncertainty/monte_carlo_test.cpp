#include "analysis/uncertainty/monte_carlo.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "analysis/method/sample_stamping.hpp"

namespace dyncal::analysis {
namespace {

double sum(std::span<const double> inputs) {
  double result = 0.0;
  for (const double input : inputs) {
    result += input;
  }
  return result;
}

// JCGM 101, 9.2.2 and 9.2.3: four normal, then four rectangular inputs of unit standard
// uncertainty.
TEST(MonteCarlo, MeetsTheAdditiveModelOfJcgm101) {
  std::vector<InputQuantity> inputs(4, InputQuantity{.name = "x", .u = 1.0});
  const auto normal = propagate_distributions(inputs, {}, sum, {.probability = 0.95});
  ASSERT_TRUE(normal.has_value());
  EXPECT_NEAR(normal->u, 2.0, 0.04);
  EXPECT_NEAR(normal->low, -3.92, 0.08);
  EXPECT_NEAR(normal->high, 3.92, 0.08);
  EXPECT_TRUE(normal->stable);
  for (InputQuantity& input : inputs) {
    input.distribution = Distribution::rectangular;
  }
  const auto rectangular = propagate_distributions(inputs, {}, sum, {.probability = 0.95});
  ASSERT_TRUE(rectangular.has_value());
  EXPECT_NEAR(rectangular->u, 2.0, 0.04);
  EXPECT_NEAR(rectangular->high, 3.88, 0.08); // the analytic value of the standard
}

TEST(MonteCarlo, DrawsCorrelatedInputsTogether) {
  const std::array inputs{InputQuantity{.name = "a", .u = 1.0},
                          InputQuantity{.name = "b", .u = 1.0}};
  const std::array correlations{InputCorrelation{0, 1, 0.8}};
  const auto result =
      propagate_distributions(inputs, correlations, [](auto x) { return x[0] - x[1]; });
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->u, std::sqrt(2.0 - 1.6), 0.01);
}

TEST(MonteCarlo, FewDegreesOfFreedomGiveTheWiderStudentDistribution) {
  const std::array inputs{InputQuantity{.name = "a", .u = 1.0, .degrees_of_freedom = 5.0}};
  const auto result = propagate_distributions(inputs, {}, sum);
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->u, std::sqrt(5.0 / 3.0), 0.03);
  EXPECT_NEAR(result->high, coverage_factor(5.0), 0.05);
}

TEST(MonteCarlo, SameSeedGivesTheSameNumbers) {
  const std::array inputs{InputQuantity{.name = "a", .u = 1.0}};
  const auto a = propagate_distributions(inputs, {}, sum, {.seed = 9, .max_trials = 20'000});
  const auto b = propagate_distributions(inputs, {}, sum, {.seed = 9, .max_trials = 20'000});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->mean, b->mean);
  EXPECT_EQ(a->trials, 20'000u);
}

TEST(MonteCarlo, SaysWhatItCannotDraw) {
  const std::array inputs{
      InputQuantity{.name = "a", .u = 1.0},
      InputQuantity{.name = "b", .u = 1.0, .distribution = Distribution::rectangular}};
  const std::array correlations{InputCorrelation{0, 1, 0.5}};
  EXPECT_FALSE(propagate_distributions(inputs, correlations, sum).has_value());
  const std::array zero{InputQuantity{.name = "a", .u = 0.0}};
  EXPECT_EQ(propagate_distributions(zero, {}, [](auto x) { return 1.0 / x[0]; }).error().code,
            ErrorCode::not_finite);
}

struct Records {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> first, second;
};

Records record(double amplitude, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Records result;
  for (int i = 0; i < 2000; ++i) {
    const double angle = 2.0 * std::numbers::pi * 40.0 * i * 1e-3;
    result.stamps_ns.push_back(1'000'000ll * i);
    result.first.push_back(amplitude * std::sin(angle + 2.9) + noise * normal(random));
    result.second.push_back(std::sin(angle) + noise * normal(random));
  }
  return result;
}

TEST(MonteCarlo, AgreesWithTheBudgetOfSampleStamping) {
  const Records acs = record(10.0, 0.01, 1), dau = record(5.0, 0.01, 2);
  SampleStampingInput input{.frequency = *Frequency::parse("40")};
  input.acs_stamps_ns = acs.stamps_ns;
  input.reference = {"reference", acs.first};
  input.sync_acs = {"sync", acs.second};
  input.dau_stamps_ns = dau.stamps_ns;
  input.sync_dau = {"sync", dau.second};
  input.dut = {{"sensor", dau.first}};
  input.adc = {1.0, 1e-3, 0.0, 2e-4};
  input.reference_delay_s = 4e-6;
  input.systematic = {.reference_magnitude_rel = 1e-3, .reference_phase_rad = 5e-4};
  const auto result = evaluate_sample_stamping(input);
  ASSERT_TRUE(result.has_value());
  const std::array link{result->reference, result->sync_acs, result->sync_dau};
  const auto check = check_transfer(result->points[0], link);
  ASSERT_TRUE(check.has_value()) << check.error().message;
  const TransferPoint& point = result->points[0];
  EXPECT_NEAR(check->magnitude.u / point.u_magnitude, 1.0, 0.02);
  EXPECT_NEAR(check->phase_rad.u / point.u_phase_rad, 1.0, 0.02);
  EXPECT_NEAR(check->magnitude.mean, point.magnitude, 0.05 * point.u_magnitude);
  EXPECT_NEAR(check->phase_rad.mean, point.phase_rad, 0.05 * point.u_phase_rad);
  EXPECT_FALSE(check_transfer(result->points[0], std::span(link).first(2)).has_value());
}

} // namespace
} // namespace dyncal::analysis
