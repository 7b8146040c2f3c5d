#include "drivers/generator/left_over_state.hpp"

#include <algorithm>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::drivers::generator {
namespace {

std::string_view name_of_family(std::string_view identity) {
  return family_of(identity).name;
}

TEST(LeftOverState, KnowsTheFamiliesByTheirIdentity) {
  EXPECT_EQ(name_of_family("Rigol Technologies,DG4162,DG4E1,00.01.14"), "rigol");
  EXPECT_EQ(name_of_family("RIGOL TECHNOLOGIES,DG1062Z,DG1ZA1,00.01.12"), "rigol");
  EXPECT_EQ(name_of_family("dyncal virtual bench,bma280,1,1"), "rigol");
  EXPECT_EQ(name_of_family("Agilent Technologies,33522A,MY5,2.03"), "keysight");
  EXPECT_EQ(name_of_family("Keysight Technologies,33612A,MY5,2.03"), "keysight");
  EXPECT_EQ(name_of_family("Rigol Technologies,DS1104Z,DS1ZA1,04"), "unknown");
  EXPECT_EQ(name_of_family("Siglent Technologies,SDG2042X,1,2"), "unknown");
  EXPECT_EQ(name_of_family(""), "unknown");
  EXPECT_FALSE(family_of("").is_known);
  EXPECT_TRUE(family_of("dyncal virtual bench,bma280,1,1").is_known);
}

TEST(LeftOverState, HasTheOffsetAndTheBurstOfEveryFamily) {
  std::vector<GeneratorFamily> families(generator_families().begin(), generator_families().end());
  ASSERT_GE(families.size(), 2U);
  families.push_back(family_of(""));
  for (const GeneratorFamily& family : families) {
    for (const std::string_view query :
         {std::string_view(offset_query), std::string_view(":SOURce1:BURSt:STATe?")}) {
      EXPECT_EQ(std::ranges::count_if(family.states,
                                      [&](const LeftOverState& one) { return query == one.query; }),
                1)
          << family.name;
    }
  }
}

// A maker, a model and states that nobody has written down.
TEST(LeftOverState, TakesAFamilyThatIsOneMoreRow) {
  std::mt19937 random(20261128);
  const auto word = [&] {
    std::string text;
    for (int i = 0; i < 8; ++i) {
      text += static_cast<char>('A' + random() % 26);
    }
    return text;
  };
  for (int draw = 0; draw < 50; ++draw) {
    const std::string maker = word();
    const std::string model = "," + word().substr(0, 3);
    const std::string reset = ":" + word() + " OFF";
    const std::string query = ":" + word() + "?";
    std::vector<GeneratorFamily> rows(generator_families().begin(), generator_families().end());
    rows.push_back({"drawn", {{maker, model}}, {{"drawn state", reset.c_str(), query.c_str()}}});
    const GeneratorFamily& found = family_of(maker + " Inc." + model + "12,1,2", rows);
    ASSERT_STREQ(found.name, "drawn");
    ASSERT_EQ(found.states.size(), 1U);
    EXPECT_EQ(found.states[0].query, query);
    EXPECT_STREQ(family_of(maker + ",1,2", rows).name, "unknown"); // the maker alone is not enough
    EXPECT_STREQ(family_of("Rigol,DG4162,1,2", rows).name, "rigol");
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
