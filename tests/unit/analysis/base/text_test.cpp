#include "analysis/base/text.hpp"

#include <gtest/gtest.h>

namespace dyncal {
namespace {

TEST(Trimmed, TakesWhiteSpaceFromBothEndsAndLeavesItInside) {
  EXPECT_EQ(trimmed("  a b\tc \r\n"), "a b\tc");
  EXPECT_EQ(trimmed("\tx"), "x");
  EXPECT_EQ(trimmed("x"), "x");
}

TEST(Trimmed, IsEmptyWhereThereIsNothingElse) {
  EXPECT_EQ(trimmed(""), "");
  EXPECT_EQ(trimmed(" \t\r\n "), "");
}

} // namespace
} // namespace dyncal
