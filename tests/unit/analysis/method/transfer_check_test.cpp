#include "analysis/method/transfer_check.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "analysis/method/sample_stamping.hpp"

namespace dyncal::analysis {
namespace {

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

TEST(TransferCheck, AgreesWithTheBudgetOfSampleStamping) {
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
  EXPECT_FALSE(check_transfer(result->points[0], std::span(link).first(0)).has_value());
}

} // namespace
} // namespace dyncal::analysis
