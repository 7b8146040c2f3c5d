#include "services/contract/channel_unit.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

constexpr double g = 9.80665;
const std::string m_s2 = R"(\metre\second\tothe{-2})";

TEST(ChannelUnit, TurnsWhatPeopleWriteIntoDsi) {
  struct Case {
    const char* written;
    std::string d_si;
    double factor;
  };
  for (const auto& [written, d_si, factor] : std::initializer_list<Case>{
           {"m/s^2", m_s2, 1.0},
           {R"(\milli\volt)", R"(\milli\volt)", 1.0},
           {"mV", R"(\milli\volt)", 1.0},
           {"g", m_s2, g},
           {"mg", m_s2, 1e-3 * g},
           {"deg/s", R"(\degree\second\tothe{-1})", 1.0},
           {"°", R"(\degree)", 1.0},
           {"%", R"(\percent)", 1.0},
           {"kPa", R"(\pascal)", 1e3},
           {"LSB", R"(\one)", 1.0},
           {"16384 LSB/g", m_s2, g / 16384.0},
           {"4096 counts/(m/s^2)", m_s2, 1.0 / 4096.0},
           {"131 LSB/(deg/s)", R"(\degree\second\tothe{-1})", 1.0 / 131.0},
           {"100 mV/g", m_s2, g / 100.0},
           {"10.2 mV/(m/s^2)", m_s2, 1.0 / 10.2},
           {"-0.1 V/g", m_s2, -10.0 * g},
       }) {
    const auto unit = parse_channel_unit(written);
    ASSERT_TRUE(unit) << written << ": " << unit.error().message;
    EXPECT_EQ(unit->d_si, d_si) << written;
    EXPECT_DOUBLE_EQ(unit->factor, factor) << written;
    EXPECT_EQ(unit->written, written);
  }
}

TEST(ChannelUnit, RefusesTheOthers) {
  for (const char* written :
       {"dB", "furlong", "G", "16384", "0 LSB/g", "LSB/g", "nan LSB/g", "100 pC/g", "1,5 LSB/g",
        "16384 LSB/furlong", "16384 LSB/", "100 mV/V/g", "", " "}) {
    EXPECT_FALSE(parse_channel_unit(written)) << written;
  }
}

TEST(ChannelUnit, TakesVoltagesByWhatTheInstrumentSays) {
  const auto unit = parse_channel_unit("100 mV/g");
  ASSERT_TRUE(unit);
  EXPECT_DOUBLE_EQ(0.1 * unit->factor_from(R"(\volt)"), g);
  EXPECT_DOUBLE_EQ(100.0 * unit->factor_from(R"(\milli\volt)"), g);
  EXPECT_DOUBLE_EQ(100.0 * unit->factor_from(""), g);
  EXPECT_DOUBLE_EQ(0.1 * unit->factor_from("V"), g); // as the heading of a file has it
  EXPECT_DOUBLE_EQ(100.0 * unit->factor_from("mV"), g);
  EXPECT_DOUBLE_EQ(100.0 * unit->factor_from("LSB"), g);
  EXPECT_DOUBLE_EQ(unit->named, g);
  EXPECT_TRUE(parse_channel_unit("1000 mV/V")->is_conversion());
}

} // namespace
} // namespace dyncal::inline contract
