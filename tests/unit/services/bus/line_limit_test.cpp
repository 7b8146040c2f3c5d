#include "services/bus/line_limit.hpp"

#include <string>

#include <gtest/gtest.h>

namespace dyncal {
namespace {

TEST(LineLimit, LetsSoManyPassInTenSecondsAndAsManyInTheNext) {
  bus::LineLimit limit(3);
  const auto begin = bus::LineLimit::Clock::now();
  int passed = 0;
  for (int i = 0; i < 1000; ++i) {
    passed += limit.passes(std::to_string(i), begin + std::chrono::milliseconds(i)) ? 1 : 0;
  }
  EXPECT_EQ(passed, 3);
  EXPECT_FALSE(limit.passes("one more", begin + std::chrono::milliseconds(9999)));
  EXPECT_TRUE(limit.passes("the next", begin + std::chrono::seconds(10)));
}

TEST(LineLimit, LetsTheSameLinePassOnceInTenMinutes) {
  bus::LineLimit limit;
  const auto begin = bus::LineLimit::Clock::now();
  EXPECT_TRUE(limit.passes("refused", begin));
  EXPECT_TRUE(limit.passes("another", begin));
  EXPECT_FALSE(limit.passes("refused", begin + std::chrono::minutes(9)));
  EXPECT_TRUE(limit.passes("refused", begin + std::chrono::minutes(10)));
}

} // namespace
} // namespace dyncal
