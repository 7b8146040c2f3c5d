#include "services/bus/fastdds/screen/growing_number.hpp"

#include <gtest/gtest.h>

namespace dyncal::bus {
namespace {

using Kind = GrowingNumber::Kind;

constexpr std::int64_t max_step = 8;

class GrowingNumberTest : public testing::Test {
protected:
  GrowingNumber number_;

  Kind judge(std::int64_t number) { return number_.judge(number, max_step); }
  void know(std::int64_t newest) {
    judge(newest - 1);
    EXPECT_EQ(judge(newest), Kind::newer);
    EXPECT_TRUE(number_.agreed());
  }
};

TEST_F(GrowingNumberTest, GrowsBySmallSteps) {
  know(100);
  EXPECT_EQ(judge(101), Kind::newer);
  EXPECT_EQ(judge(109), Kind::newer);
  EXPECT_EQ(judge(109), Kind::known);
  EXPECT_EQ(judge(3), Kind::known);
}

TEST_F(GrowingNumberTest, DoesNotJump) {
  know(100);
  EXPECT_EQ(judge(109), Kind::implausible);
  EXPECT_FALSE(number_.is_plausible(109, max_step));
  EXPECT_EQ(judge(101), Kind::newer) << "the real one goes on";
  EXPECT_TRUE(number_.is_plausible(109, max_step));
}

TEST_F(GrowingNumberTest, GoesOnElsewhereWhenManyInARowDo) {
  know(100);
  for (int i = 0; i < GrowingNumber::sure_after - 1; ++i) {
    EXPECT_EQ(judge(5000 + 300 * i), Kind::implausible);
    EXPECT_EQ(judge(50), Kind::known) << "what is given again decides nothing";
  }
  EXPECT_EQ(judge(7000), Kind::newer);
  EXPECT_EQ(judge(7001), Kind::newer);
}

TEST_F(GrowingNumberTest, BelievesNoJumpsThatDoNotGoOnFromOneAnother) {
  know(100);
  for (int i = 0; i < 5 * GrowingNumber::sure_after; ++i) {
    EXPECT_EQ(judge(1'000'000 - 1000 * i), Kind::implausible);
  }
  EXPECT_EQ(judge(101), Kind::newer);
}

TEST_F(GrowingNumberTest, BelievesNoJumpsBetweenRealOnes) {
  know(100);
  for (int i = 1; i < 5 * GrowingNumber::sure_after; ++i) {
    EXPECT_EQ(judge(5000 + i), Kind::implausible);
    EXPECT_EQ(judge(100 + i), Kind::newer);
  }
}

// A wrong one may be the first that is heard.
TEST_F(GrowingNumberTest, KnowsNothingBeforeTwoAgree) {
  EXPECT_EQ(judge(2'000'000'000), Kind::newer);
  EXPECT_EQ(judge(40), Kind::newer);
  EXPECT_FALSE(number_.agreed());
  EXPECT_EQ(judge(41), Kind::newer);
  EXPECT_TRUE(number_.agreed());
  EXPECT_EQ(judge(2'000'000'000), Kind::implausible);
}

TEST_F(GrowingNumberTest, AgreesWithItself) {
  judge(1);
  judge(1);
  EXPECT_TRUE(number_.agreed()) << "a writer of one sample repeats it";
  EXPECT_EQ(judge(255), Kind::implausible);
}

} // namespace
} // namespace dyncal::bus
