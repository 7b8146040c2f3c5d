#include "analysis/step/short_disturbance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
};

// 80 Hz, 3 s, noise of 1 %.
Record record_of(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 0.01);
  Record record;
  for (int i = 0; i < 3000; ++i) {
    record.stamps_ns.push_back(1'000'000LL * i);
    record.values.push_back(std::sin(2.0 * pi * 80.0 * i * 1e-3) + normal(random));
  }
  return record;
}

std::optional<ShortDisturbance> found_in(const Record& record) {
  return find_short_disturbance(*Frequency::parse("80"), record.stamps_ns, record.values);
}

// Half a sine of 10 ms.
void knock(Record& record, std::size_t at, double size) {
  for (std::size_t i = 0; i < 10; ++i) {
    record.values[at + i] += size * std::sin(pi * (static_cast<double>(i) + 0.5) / 10.0);
  }
}

class Knock : public testing::TestWithParam<double> {};

TEST_P(Knock, IsFoundWhereItIsAndNotMuchMore) {
  Record record = record_of(1);
  knock(record, 1200, GetParam());
  const auto found = found_in(record);
  ASSERT_TRUE(found.has_value());
  EXPECT_LE(found->first_ns, 1'200'000'000);
  EXPECT_GE(found->last_ns, 1'209'000'000);
  EXPECT_LE(found->last_ns - found->first_ns, 60'000'000);
}

INSTANTIATE_TEST_SUITE_P(ShortDisturbance, Knock, testing::Values(0.5, -3.0, 50.0));

TEST(ShortDisturbance, IsNoneInNoise) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    EXPECT_FALSE(found_in(record_of(seed)).has_value());
  }
}

TEST(ShortDisturbance, IsNoneWhereTheToolsOfOtherFaultsLook) {
  Record clipped = record_of(2);
  for (double& value : clipped.values) {
    value = std::min(value, 0.9);
  }
  EXPECT_FALSE(found_in(clipped).has_value());
  Record stuck = record_of(3);
  std::fill(stuck.values.begin() + 1000, stuck.values.begin() + 1050, stuck.values[1000]);
  EXPECT_FALSE(found_in(stuck).has_value());
  Record twice = record_of(4);
  knock(twice, 500, 2.0);
  knock(twice, 2000, 2.0);
  EXPECT_FALSE(found_in(twice).has_value());
  Record shifted = record_of(5);
  for (std::size_t i = 1500; i < shifted.values.size(); ++i) {
    shifted.values[i] *= 1.3;
  }
  EXPECT_FALSE(found_in(shifted).has_value());
}

} // namespace
} // namespace dyncal::analysis
