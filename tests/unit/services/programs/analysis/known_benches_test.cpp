#include "services/programs/analysis/known_benches.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;

class KnownBenchesTest : public testing::Test {
protected:
  KnownBenches known_{{[](const std::string& bench) { return bench.starts_with("live"); },
                       [](const std::string& bench, const std::string& source) {
                         return bench.starts_with("live") && source == "dau";
                       }}};
  KnownBenches::Instant now_{1h};

  bool hear(const std::string& bench, const std::string& source) {
    KnownSource* const heard = known_.heard(bench, source, now_ += 1ms);
    if (heard != nullptr) {
      heard->status.emplace().message(source);
    }
    return heard != nullptr;
  }
  void hear_benches(const std::string& name, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      hear(name + std::to_string(i), "dau");
    }
  }
  bool knows(const std::string& bench) { return !known_.sources_of(bench).empty(); }
};

TEST_F(KnownBenchesTest, KnowsTheSourcesOfEveryBench) {
  hear("b1", "dau");
  hear("b1", "acs");
  hear("b2", "dau");
  EXPECT_EQ(known_.sources_of("b1").size(), 2U);
  EXPECT_EQ(known_.sources_of("b1").at("acs").status->message(), "acs");
  EXPECT_EQ(known_.sources_of("b2").size(), 1U);
  EXPECT_TRUE(known_.sources_of("b3").empty());
  EXPECT_EQ(known_.sources(), 3U);
  EXPECT_EQ(known_.left_out().benches + known_.left_out().sources, 0U);
}

TEST_F(KnownBenchesTest, DropsTheBenchesOfWhichNothingCameForLongest) {
  hear("talks", "dau");
  hear("silent", "dau");
  for (std::size_t i = 0; i < 2 * KnownBenches::max_benches; ++i) {
    hear("b" + std::to_string(i), "dau");
    hear("talks", "dau");
  }
  EXPECT_EQ(known_.benches(), KnownBenches::max_benches);
  EXPECT_TRUE(knows("talks"));
  EXPECT_FALSE(knows("silent"));
  EXPECT_EQ(known_.left_out().benches, KnownBenches::max_benches + 2);
}

TEST_F(KnownBenchesTest, DropsNoBenchOfALivingRun) {
  hear("live", "dau");
  hear_benches("b", 2 * KnownBenches::max_benches);
  EXPECT_TRUE(knows("live"));
  hear_benches("live", KnownBenches::max_benches);
  EXPECT_EQ(known_.benches(), KnownBenches::max_benches);
  EXPECT_TRUE(knows("live"));
  EXPECT_FALSE(hear("another", "dau"));
  EXPECT_FALSE(knows("another"));
}

TEST_F(KnownBenchesTest, DropsNoSourceOfALivingRun) {
  hear("live", "dau");
  hear("b", "dau");
  for (std::size_t i = 0; i < 2 * KnownBenches::max_sources; ++i) {
    EXPECT_TRUE(hear("live", "s" + std::to_string(i)));
    EXPECT_TRUE(hear("b", "s" + std::to_string(i)));
  }
  EXPECT_EQ(known_.sources(), 2 * KnownBenches::max_sources);
  EXPECT_TRUE(known_.sources_of("live").contains("dau"));
  EXPECT_FALSE(known_.sources_of("b").contains("dau"));
  EXPECT_EQ(known_.left_out().sources, 2 * (KnownBenches::max_sources + 1));
}

} // namespace
} // namespace dyncal::inline programs
