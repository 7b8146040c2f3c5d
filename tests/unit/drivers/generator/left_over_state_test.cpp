#include "drivers/generator/left_over_state.hpp"

#include <algorithm>
#include <string_view>

#include <gtest/gtest.h>

namespace dyncal::drivers::generator {
namespace {

TEST(LeftOverState, KnowsTheFamiliesByTheirIdentity) {
  EXPECT_EQ(family_of("Rigol Technologies,DG4162,DG4E1,00.01.14"), GeneratorFamily::rigol);
  EXPECT_EQ(family_of("RIGOL TECHNOLOGIES,DG1062Z,DG1ZA1,00.01.12"), GeneratorFamily::rigol);
  EXPECT_EQ(family_of("dyncal virtual bench,bma280,1,1"), GeneratorFamily::rigol);
  EXPECT_EQ(family_of("Agilent Technologies,33522A,MY5,2.03"), GeneratorFamily::keysight);
  EXPECT_EQ(family_of("Keysight Technologies,33612A,MY5,2.03"), GeneratorFamily::keysight);
  EXPECT_EQ(family_of("Rigol Technologies,DS1104Z,DS1ZA1,04"), GeneratorFamily::unknown);
  EXPECT_EQ(family_of("Siglent Technologies,SDG2042X,1,2"), GeneratorFamily::unknown);
  EXPECT_EQ(family_of(""), GeneratorFamily::unknown);
}

TEST(LeftOverState, HasTheOffsetAndTheBurstOfEveryFamily) {
  for (const auto family :
       {GeneratorFamily::rigol, GeneratorFamily::keysight, GeneratorFamily::unknown}) {
    const auto states = left_over_states(family);
    for (const std::string_view query :
         {std::string_view(offset_query), std::string_view(":SOURce1:BURSt:STATe?")}) {
      EXPECT_EQ(std::count_if(states.begin(), states.end(),
                              [&](const LeftOverState& one) { return query == one.query; }),
                1);
    }
  }
}

TEST(LeftOverState, ReadsWhatInstrumentsAnswer) {
  for (const char* reset : {"OFF", "0", "NORMAL", "NORM\r", "0.000000E+00", "+0.00000000000000E+00",
                            "-0.0005", "0.000"}) {
    EXPECT_EQ(says_reset(reset), true) << reset;
  }
  for (const char* left : {"ON", "1", "INVERTED", "INV", "-2.000000E+00", "0.0021"}) {
    EXPECT_EQ(says_reset(left), false) << left;
  }
  for (const char* neither : {"", "HIZ", "0V", "Command error"}) {
    EXPECT_FALSE(says_reset(neither).has_value()) << neither;
  }
}

} // namespace
} // namespace dyncal::drivers::generator
