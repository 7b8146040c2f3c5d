#include "drivers/dso/scope_commands.hpp"

#include <gtest/gtest.h>

namespace dyncal::drivers::dso {
namespace {

TEST(ScopeCommands, AreFoundByTheIdentityOfTheInstrument) {
  EXPECT_STREQ(scope_by_identity("RIGOL TECHNOLOGIES,MSO5072,MS5A212003221,00.01.03.00.03")->family,
               "rigol-mso5000");
  EXPECT_STREQ(scope_by_identity("RIGOL TECHNOLOGIES,DS1104Z,DS1ZA1,00.04.04")->family,
               "rigol-ds1000z");
  EXPECT_STREQ(scope_by_identity("KEYSIGHT TECHNOLOGIES,DSO-X 3024T,MY1,07.30")->family,
               "keysight-infiniivision");
  EXPECT_EQ(scope_by_identity("ACME,TOASTER,1,2"), nullptr);
  EXPECT_EQ(scope_by_identity("MSO5072"), nullptr);
  EXPECT_EQ(scope_by_family("rigol-mso5000"), scope_by_identity("RIGOL TECHNOLOGIES,MSO5354,1,2"));
}

TEST(ScopeCommands, OfEveryFamilyAreComplete) {
  ASSERT_EQ(known_scopes().size(), 3U);
  for (const ScopeCommands& scope : known_scopes()) {
    EXPECT_FALSE(scope.models.empty()) << scope.family;
    EXPECT_FALSE(scope.set_up.empty()) << scope.family;
    EXPECT_FALSE(scope.finished.empty()) << scope.family;
    EXPECT_GT(scope.max_points_per_block, 0U) << scope.family;
    EXPECT_EQ(scope_by_family(scope.family), &scope);
  }
}

TEST(ScopeCommands, TakeWhatAFamilyDoesNotNameFromTheBaseRow) {
  const ScopeCommands* rigol = scope_by_family("rigol-mso5000");
  const ScopeCommands* keysight = scope_by_family("keysight-infiniivision");
  ASSERT_NE(rigol, nullptr);
  ASSERT_NE(keysight, nullptr);
  EXPECT_STREQ(rigol->memory_depth, ":ACQuire:MDEPth");
  EXPECT_EQ(keysight->memory_depth, nullptr);
  EXPECT_STREQ(keysight->state, ":RSTate?");
  EXPECT_STREQ(keysight->input_scale, rigol->input_scale);
  EXPECT_EQ(scope_by_family("acme-toaster"), nullptr);
}

TEST(ScopeCommands, NameTheInputTheyActOn) {
  EXPECT_EQ(for_input(":CHANnel<n>:SCALe", 3), ":CHANnel3:SCALe");
  EXPECT_EQ(for_input("<n><n>", 12), "1212");
  EXPECT_EQ(for_input(":STOP", 1), ":STOP");
}

} // namespace
} // namespace dyncal::drivers::dso
