#include "services/bus/names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::bus {
namespace {

using testing::HasSubstr;

TEST(Names, HaveOneTo64Characters) {
  EXPECT_TRUE(check_name("source", "a"));
  EXPECT_TRUE(check_name("source", std::string(64, 'a')));
  EXPECT_FALSE(check_name("source", ""));
  const auto too_long = check_name("source", std::string(65, 'a'));
  ASSERT_FALSE(too_long);
  EXPECT_EQ(too_long.error().code, base::ErrorCode::bad_argument);
  EXPECT_THAT(too_long.error().message, HasSubstr("source \"aaaa"));
  EXPECT_THAT(too_long.error().message, HasSubstr("65 bytes"));
}

TEST(Names, OfChannelsHaveUpTo128Characters) {
  EXPECT_TRUE(check_name("channel", std::string(128, 'a'), max_channel));
  EXPECT_FALSE(check_name("channel", std::string(129, 'a'), max_channel));
}

TEST(Names, OfBenchesAreNoPatterns) {
  EXPECT_TRUE(check_bench_name("acc-1"));
  for (const char* pattern : {"*", "acc*", "acc-?", "acc-[12]"}) {
    EXPECT_FALSE(check_bench_name(pattern)) << pattern;
  }
}

TEST(Names, OfWhoCatchesUpAreLongerAndNoPatterns) {
  EXPECT_TRUE(check_asker_name(std::string(128, 'a')));
  EXPECT_FALSE(check_asker_name(std::string(129, 'a')));
  EXPECT_FALSE(check_asker_name(""));
  EXPECT_FALSE(check_asker_name("analysis-*"));
}

TEST(Names, OfRunsMakeAPartitionThatIsNoPattern) {
  EXPECT_EQ(partition_of_run("acc-1", "20261125T080000.000Z"), "acc-1/20261125T080000.000Z");
  EXPECT_EQ(partition_of_run("acc-1", "a*b?[c]"), "acc-1/a_b__c_");
}

} // namespace
} // namespace dyncal::bus
