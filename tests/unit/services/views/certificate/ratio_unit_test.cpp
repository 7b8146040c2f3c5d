#include "services/views/certificate/ratio_unit.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline views {
namespace {

TEST(RatioUnit, OfAlikeAndOfDifferentKinds) {
  EXPECT_EQ(ratio_in_d_si(R"(\one)"), R"(\one)");
  EXPECT_EQ(ratio_in_d_si("1"), R"(\one)");
  EXPECT_EQ(ratio_in_d_si("(V)/(m/s^2)"), R"(\volt\metre\tothe{-1}\second\tothe{2})");
  EXPECT_EQ(ratio_in_d_si("(uT)/(m/s^2)"), R"(\micro\tesla\metre\tothe{-1}\second\tothe{2})");
  EXPECT_EQ(ratio_in_d_si("(rad/s)/(rad/s)"),
            R"(\radian\second\tothe{-1}\radian\tothe{-1}\second)");
  EXPECT_EQ(ratio_in_d_si("(V)/(1)"), R"(\volt)");
  EXPECT_EQ(ratio_in_d_si("(1)/(mV)"), R"(\milli\volt\tothe{-1})");
  EXPECT_EQ(ratio_in_d_si(R"((\volt)/(\metre\second\tothe{-2}))"),
            R"(\volt\metre\tothe{-1}\second\tothe{2})");
}

TEST(RatioUnit, OfWhatIsNotAUnit) {
  for (const char* text :
       {"", "counts", "(V)/(g)", "(V)/", "()/()", "V/(m/s^2)", "(V)/(\\per\\metre)"}) {
    EXPECT_FALSE(ratio_in_d_si(text)) << text;
  }
}

} // namespace
} // namespace dyncal::inline views
