#include "services/bench/file/sensitivity_unit.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline bench {
namespace {

TEST(SensitivityUnit, KnowsWhatCertificatesWrite) {
  struct Case {
    const char* text;
    double factor;
    const char* output;
    const char* input;
  };
  for (const Case& one :
       {Case{"pC/(m/s^2)", 1e-12, "C", "m/s^2"}, Case{"pC/g", 1e-12 / 9.80665, "C", "m/s^2"},
        Case{"mV/(m/s^2)", 1e-3, "V", "m/s^2"}, Case{"mV/g", 1e-3 / 9.80665, "V", "m/s^2"},
        Case{"V/(m/s)", 1.0, "V", "m/s"}, Case{"mV/pC", 1e9, "V", "C"},
        Case{"mV/m/s^2", 1e-3, "V", "m/s^2"}}) {
    const auto unit = parse_sensitivity_unit(one.text);
    ASSERT_TRUE(unit) << one.text;
    EXPECT_DOUBLE_EQ(unit->factor, one.factor) << one.text;
    EXPECT_EQ(unit->output, one.output) << one.text;
    EXPECT_EQ(unit->input, one.input) << one.text;
    EXPECT_FALSE(unit->is_one());
  }
  EXPECT_TRUE(parse_sensitivity_unit("1").value().is_one());
  const auto gain = parse_sensitivity_unit("mV/V");
  ASSERT_TRUE(gain);
  EXPECT_DOUBLE_EQ(gain->factor, 1e-3);
  EXPECT_FALSE(gain->is_one());
  for (const char* const text : {"", "pC", "m/s^2", "pC/", "/g", "bananas/g", "V/V/V"}) {
    EXPECT_FALSE(parse_sensitivity_unit(text)) << text;
  }
}

} // namespace
} // namespace dyncal::inline bench
