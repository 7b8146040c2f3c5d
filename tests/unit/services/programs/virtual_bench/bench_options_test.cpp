#include "services/programs/virtual_bench/bench_options.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline programs::virtual_bench {
namespace {

using testing::HasSubstr;

Expected<std::optional<BenchOptions>> parse(std::vector<std::string> words) {
  words.insert(words.begin(), "dyncal-virtual-bench");
  std::vector<char*> arguments;
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  return parse_command_line(static_cast<int>(arguments.size()), arguments.data());
}

TEST(BenchOptions, AnInterferometerIsFast) {
  const auto options = parse({"--interferometer", "632.82", "--skew-u", "2e-9"});
  ASSERT_TRUE(options && *options);
  const auto& bench = (*options)->bench;
  EXPECT_EQ(bench.acs_rate_hz, 500'000);
  ASSERT_TRUE(bench.interferometer);
  EXPECT_DOUBLE_EQ(bench.interferometer->wavelength_m, 632.82e-9);
  EXPECT_DOUBLE_EQ(bench.interferometer->u_skew_s, 2e-9);
}

TEST(BenchOptions, ABenchHasAReferenceUnlessAskedOtherwise) {
  const auto options = parse({});
  ASSERT_TRUE(options && *options);
  EXPECT_FALSE((*options)->bench.interferometer);
  EXPECT_EQ((*options)->bench.acs_rate_hz, 20'000);
}

TEST(BenchOptions, RefusesWhatAnInterferometerCannotShow) {
  const auto slow = parse({"--interferometer", "632.82", "--acs-rate", "20000"});
  ASSERT_FALSE(slow);
  EXPECT_THAT(slow.error().message, HasSubstr("at least 100000"));
  const auto hum = parse({"--interferometer", "632.82", "--fault", "hum=0.01,at=reference"});
  ASSERT_FALSE(hum);
  EXPECT_THAT(hum.error().message, HasSubstr("no faults at reference or sync_acs"));
  EXPECT_TRUE(parse({"--interferometer", "632.82", "--fault", "loss=0.01,at=acs"}));
}

TEST(BenchOptions, RefusesATableOfWhatIsNoReferenceOrIsRecorded) {
  EXPECT_TRUE(parse({"--acs-table", "t.csv"}));
  const auto laser = parse({"--acs-table", "t.csv", "--interferometer", "632.82"});
  ASSERT_FALSE(laser);
  EXPECT_THAT(laser.error().message, HasSubstr("signals of an interferometer"));
  const auto recorded = parse({"--acs-table", "t.csv", "--record-csv", "folder"});
  ASSERT_FALSE(recorded);
  EXPECT_THAT(recorded.error().message, HasSubstr("not for --record-csv"));
}

TEST(BenchOptions, HasPulsesBesideAReferenceAlone) {
  const auto options = parse({"--acs-pulses"});
  ASSERT_TRUE(options && *options);
  EXPECT_TRUE((*options)->bench.acs_pulses);
  const auto laser = parse({"--acs-pulses", "--interferometer", "632.82"});
  ASSERT_FALSE(laser);
  EXPECT_THAT(laser.error().message, HasSubstr("records no pulses"));
}

// The ranges of a multi-sine are for its peak, which is above each level and below their sum.
TEST(BenchOptions, HasRangesForThePeakOfAMultisine) {
  const auto options = parse({"--multisine", "2", "--frequencies", "20.5,31.5,63.5,80.5"});
  ASSERT_TRUE(options && *options) << options.error().message;
  EXPECT_GT((*options)->bench.highest_level_m_s2, 20.0);
  EXPECT_LT((*options)->bench.highest_level_m_s2, 56.0); // 1.4 times the sum
}

} // namespace
} // namespace dyncal::inline programs::virtual_bench
