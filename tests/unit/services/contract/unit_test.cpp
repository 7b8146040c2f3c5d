#include "services/contract/unit.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

TEST(Unit, TranslatesShortFormsAndKeepsDSi) {
  EXPECT_EQ(to_d_si("m/s^2"), R"(\metre\second\tothe{-2})");
  EXPECT_EQ(to_d_si(R"(\milli\volt)"), R"(\milli\volt)");
  EXPECT_EQ(to_d_si(R"(\metre\per\second\tothe{2})"), R"(\metre\per\second\tothe{2})");
  EXPECT_EQ(short_form(R"(\metre\second\tothe{-2})"), "m/s^2");
  EXPECT_EQ(short_form(R"(\bar)"), R"(\bar)");
}

TEST(Unit, RefusesWhatIsNeither) {
  for (const char* wrong :
       {"", "furlong", R"(\furlong)", R"(\milli)", R"(\tothe{2})", R"(\metre\tothe{x})",
        R"(\metre\tothe{-2)", R"(\A.U.)", R"(\milli\milli\metre)", "/hertz"}) {
    EXPECT_FALSE(to_d_si(wrong)) << wrong;
  }
}

} // namespace
} // namespace dyncal::inline contract
