#include "analysis/base/preferred_frequencies.hpp"

#include <gmock/gmock.h>

namespace dyncal::analysis {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Optional;

// The table of ISO 266.
TEST(PreferredFrequencies, AreTheThirdOctavesOfTheStandard) {
  EXPECT_THAT(preferred_frequencies("third-octave 10..200"),
              Optional(ElementsAre("10", "12.5", "16", "20", "25", "31.5", "40", "50", "63", "80",
                                   "100", "125", "160", "200")));
  EXPECT_THAT(preferred_frequencies("third-octave 0.1..1.25"),
              Optional(ElementsAre("0.1", "0.125", "0.16", "0.2", "0.25", "0.315", "0.4", "0.5",
                                   "0.63", "0.8", "1", "1.25")));
  EXPECT_THAT(preferred_frequencies("third-octave 0.01 .. 0.02"),
              Optional(ElementsAre("0.01", "0.0125", "0.016", "0.02")));
  EXPECT_THAT(preferred_frequencies("third-octave 900..13e3"),
              Optional(ElementsAre("1000", "1250", "1600", "2000", "2500", "3150", "4000", "5000",
                                   "6300", "8000", "10000", "12500")));
}

TEST(PreferredFrequencies, AreTheOctavesThatCountFrom1000Hz) {
  EXPECT_THAT(preferred_frequencies("octave 1..2000"),
              Optional(ElementsAre("1", "2", "4", "8", "16", "31.5", "63", "125", "250", "500",
                                   "1000", "2000")));
  EXPECT_THAT(preferred_frequencies("octave 0.1..0.6"),
              Optional(ElementsAre("0.125", "0.25", "0.5")));
}

TEST(PreferredFrequencies, AreNoneWhereNoneLies) {
  EXPECT_THAT(preferred_frequencies("third-octave 21..24"), Optional(IsEmpty()));
}

TEST(PreferredFrequencies, AreNotMadeOfOtherTexts) {
  for (const char* text :
       {"", "third-octave", "third-octave 10", "third-octave 10-200", "third-octave 200..10",
        "third-octave 0..200", "third-octave -1..200", "third-octave a..b", "third-octave 10..1e7",
        "sixth-octave 10..20", "10..200", "octave 10...200"}) {
    EXPECT_FALSE(preferred_frequencies(text)) << text;
  }
}

} // namespace
} // namespace dyncal::analysis
