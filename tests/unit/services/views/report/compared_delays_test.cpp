#include "services/views/report/compared_delays.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline views {
namespace {

StoredResult result_of(double delay_s, const std::vector<std::string>& flag_names = {}) {
  StoredResult result;
  result.channels.emplace_back().channel = "dau/x";
  result.channels.back().flag_names = flag_names;
  analysis::GroupDelay delay;
  delay.delay_s = delay_s;
  delay.of_delay = {1e-6, 2.0, analysis::coverage_factor(2.0)};
  result.group_delays = {{"dau/x", delay}};
  return result;
}

PairedPoints paired_at(double frequency_hz) {
  const PointIdentity identity{.channel = "dau/x", .frequency_hz = frequency_hz};
  PairedPoints paired;
  paired.pairs.push_back({identity, identity, {}, {}});
  return paired;
}

TEST(ComparedDelays, HaveTheNormalisedErrorOfTheirDifference) {
  const auto delays = compare_delays(result_of(1.510e-3), result_of(1.500e-3), paired_at(80));
  ASSERT_EQ(delays.size(), 1U);
  EXPECT_EQ(delays[0].channel, "dau/x");
  const double expanded_s = std::sqrt(2.0) * 1e-6 * analysis::coverage_factor(2.0);
  EXPECT_NEAR(delays[0].difference.value, 10e-6, 1e-12);
  EXPECT_NEAR(delays[0].difference.of_value.expanded(), expanded_s, 1e-12);
  EXPECT_NEAR(delays[0].difference.of_value.degrees_of_freedom, 4.0, 1e-9);
  EXPECT_NEAR(delays[0].difference.normalised_error(), 10e-6 / expanded_s, 1e-9);
}

TEST(ComparedDelays, LeaveOutWhatIsNoDelayOrMayBeAnother) {
  for (const char* flag : {"group_delay_ambiguous", "group_delay_not_constant"}) {
    EXPECT_TRUE(compare_delays(result_of(1e-3, {flag}), result_of(1e-3), paired_at(80)).empty());
    EXPECT_TRUE(compare_delays(result_of(1e-3), result_of(1e-3, {flag}), paired_at(80)).empty());
  }
  EXPECT_EQ(compare_delays(result_of(1e-3, {"distorted"}), result_of(1e-3), paired_at(80)).size(),
            1U);
}

TEST(ComparedDelays, LeaveOutOtherFrequencies) {
  PairedPoints paired = paired_at(80);
  paired.only_second = {{.channel = "dau/x", .frequency_hz = 100}};
  EXPECT_TRUE(compare_delays(result_of(1e-3), result_of(1e-3), paired).empty());
  paired.only_second = {{.channel = "dau/y", .frequency_hz = 100}};
  EXPECT_EQ(compare_delays(result_of(1e-3), result_of(1e-3), paired).size(), 1U);
}

} // namespace
} // namespace dyncal::inline views
