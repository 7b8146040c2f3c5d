#include "services/bus/line_limit.hpp"

#include <gtest/gtest.h>

namespace dyncal {
namespace {

TEST(LineLimit, LetsSoManyPassInTenSecondsAndAsManyInTheNext) {
  bus::LineLimit limit(3);
  const auto begin = bus::LineLimit::Clock::now();
  int passed = 0;
  for (int i = 0; i < 1000; ++i) {
    passed += limit.passes(begin + std::chrono::milliseconds(i)) ? 1 : 0;
  }
  EXPECT_EQ(passed, 3);
  EXPECT_FALSE(limit.passes(begin + std::chrono::milliseconds(9999)));
  EXPECT_TRUE(limit.passes(begin + std::chrono::seconds(10)));
}

} // namespace
} // namespace dyncal
