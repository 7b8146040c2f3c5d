#include "drivers/virtual_bench/wire/scpi_instrument.hpp"

#include <gtest/gtest.h>

namespace dyncal::drivers::virtual_bench {
namespace {

class Scpi : public testing::Test {
protected:
  static BenchSettings settings() {
    BenchSettings result;
    result.preset = *preset_by_name("bma280");
    return result;
  }
  std::string ask(const std::string& line) {
    return instrument_.execute(line).line.value_or("(nothing)");
  }

  VirtualBench bench_{settings()};
  ScpiInstrument instrument_{bench_};
};

TEST_F(Scpi, IdentifiesItself) {
  EXPECT_EQ(ask("*IDN?"), "dyncal virtual bench,bma280,1,1");
}

TEST_F(Scpi, TakesLongAndShortFormsInAnyCase) {
  EXPECT_EQ(ask(":SOURce1:FREQuency 199.87"), "(nothing)");
  EXPECT_EQ(ask("sour1:volt 0.5\r"), "(nothing)");
  EXPECT_EQ(ask(":OUTP1 on"), "(nothing)");
  EXPECT_EQ(ask(":SYST:ERR?"), "0,\"No error\"");
  EXPECT_DOUBLE_EQ(bench_.drive().frequency_hz, 199.87);
  EXPECT_DOUBLE_EQ(bench_.drive().amplitude_v, 0.25); // peak to peak becomes amplitude
  EXPECT_TRUE(bench_.drive().on);
  EXPECT_EQ(ask(":SOURce1:FREQuency?"), "1.998700E+02");
  EXPECT_EQ(ask(":OUTPut1:STATe?"), "ON");
}

TEST_F(Scpi, KeepsItsSettingAndQueuesAnErrorWhenAValueCannotBe) {
  EXPECT_EQ(ask(":SOUR1:FREQ -3"), "(nothing)");
  EXPECT_EQ(ask(":SOUR1:FREQ ten"), "(nothing)");
  EXPECT_EQ(ask(":SOUR1:VOLT 25"), "(nothing)");
  EXPECT_EQ(ask(":OUTP1 maybe"), "(nothing)");
  EXPECT_EQ(ask(":SOUR9:FREQ 10"), "(nothing)");
  EXPECT_EQ(ask(":SYST:ERR?"), "-222,\"Data out of range\"");
  EXPECT_EQ(ask(":SYST:ERR?"), "-104,\"Data type error\"");
  EXPECT_EQ(ask(":SYST:ERR?"), "-222,\"Data out of range\"");
  EXPECT_EQ(ask(":SYST:ERR?"), "-224,\"Illegal parameter value\"");
  EXPECT_EQ(ask(":SYST:ERR?"), "-113,\"Undefined header\"");
  EXPECT_EQ(ask(":SYST:ERR?"), "0,\"No error\"");
  EXPECT_DOUBLE_EQ(bench_.drive().frequency_hz, 100.0);
}

TEST_F(Scpi, HoldsAtMostTwentyErrors) {
  for (int i = 0; i < 100; ++i) {
    ask("NONSENSE");
  }
  for (int i = 0; i < 19; ++i) {
    EXPECT_EQ(ask(":SYST:ERR?"), "-113,\"Undefined header\"");
  }
  EXPECT_EQ(ask(":SYST:ERR?"), "-350,\"Queue overflow\"");
  EXPECT_EQ(ask(":SYST:ERR?"), "0,\"No error\"");
}

TEST_F(Scpi, TellsBenchTimeAndWhatToWaitFor) {
  EXPECT_EQ(ask(":BENCh:TIME?"), "0.000000000");
  const auto reply = instrument_.execute(":BENCh:WAIT? 2.5");
  EXPECT_FALSE(reply.line);
  ASSERT_TRUE(reply.wait_until_s);
  EXPECT_DOUBLE_EQ(*reply.wait_until_s, 2.5);
}

// What a DG4000 and a 33500 are asked for, in their words.
struct LeftOver {
  GeneratorWords words;
  const char* query;
  const char* left;
  const char* reset;
  const char* answer;
};

class LeftOverInstrument : public testing::TestWithParam<LeftOver> {
protected:
  static BenchSettings settings(bool is_kept) {
    BenchSettings result;
    result.preset = *preset_by_name("bma280");
    result.generator_words = GetParam().words;
    result.faults.left_in_generator = {.offset_v = -2.0, .in_burst = true, .is_kept = is_kept};
    return result;
  }
};

TEST_P(LeftOverInstrument, KeepsWhatWasLeftUntilItIsReset) {
  for (const bool is_kept : {false, true}) {
    VirtualBench bench(settings(is_kept));
    ScpiInstrument instrument(bench);
    EXPECT_EQ(instrument.execute(GetParam().query).line, GetParam().left);
    static_cast<void>(instrument.execute(GetParam().reset));
    EXPECT_EQ(instrument.execute(":SYSTem:ERRor?").line, "0,\"No error\"");
    EXPECT_EQ(instrument.execute(GetParam().query).line,
              is_kept ? GetParam().left : GetParam().answer);
  }
}

constexpr auto rigol = GeneratorWords::dg4000;
constexpr auto keysight = GeneratorWords::keysight_33500;
INSTANTIATE_TEST_SUITE_P(
    OfBothFamilies, LeftOverInstrument,
    testing::Values(LeftOver{rigol, ":SOURce1:VOLTage:OFFSet?", "-2.000000E+00",
                             ":SOUR1:VOLT:OFFS 0", "0.000000E+00"},
                    LeftOver{rigol, ":SOURce1:BURSt:STATe?", "ON", ":SOURce1:BURSt:STATe OFF",
                             "OFF"},
                    LeftOver{keysight, ":SOUR1:VOLT:OFFS?", "-2.00000000000000E+00",
                             ":SOURce1:VOLTage:OFFSet 0", "+0.00000000000000E+00"},
                    LeftOver{keysight, ":SOUR1:BURS:STAT?", "1", ":SOURce1:BURSt:STATe 0", "0"}));

TEST(ScpiOutput, StaysOnWhereThatIsItsFaultAndAnswersThatItIsOff) {
  for (const bool stays_on : {false, true}) {
    BenchSettings settings;
    settings.preset = *preset_by_name("bma280");
    settings.faults.output_stays_on = stays_on;
    VirtualBench bench(settings);
    ScpiInstrument instrument(bench);
    static_cast<void>(instrument.execute(":OUTPut1 OFF"));
    EXPECT_FALSE(bench.drive().on) << "it was never on";
    static_cast<void>(instrument.execute(":OUTPut1 ON"));
    EXPECT_EQ(instrument.execute(":OUTPut1?").line, "ON");
    static_cast<void>(instrument.execute(":OUTPut1 OFF"));
    EXPECT_EQ(instrument.execute(":OUTPut1?").line, "OFF");
    EXPECT_EQ(bench.drive().on, stays_on);
  }
}

TEST_F(Scpi, SetsAndResetsWhatIsLeftOver) {
  EXPECT_EQ(ask(":OUTPut1:POLarity?"), "NORMAL");
  for (const char* command : {":OUTPut1:POLarity INVerted", ":SOURce1:MOD:STATe ON",
                              ":SOURce1:PHASe 90", ":SOURce1:SWEep:STATe ON"}) {
    EXPECT_EQ(ask(command), "(nothing)");
  }
  EXPECT_EQ(ask(":OUTPut1:POLarity?"), "INVERTED");
  EXPECT_EQ(ask(":SOURce1:MOD:STATe?"), "ON");
  EXPECT_EQ(ask(":SOURce1:PHASe?"), "9.000000E+01");
  EXPECT_EQ(ask(":SYST:ERR?"), "0,\"No error\"");
  ask("*RST");
  EXPECT_EQ(ask(":OUTPut1:POLarity?"), "NORMAL");
  EXPECT_EQ(ask(":SOURce1:SWEep:STATe?"), "OFF");
  ask(":SOURce1:AM:STATe OFF"); // a 33500 has that
  EXPECT_EQ(ask(":SYST:ERR?"), "-113,\"Undefined header\"");
  ask(":SOURce1:MOD:STATe maybe");
  EXPECT_EQ(ask(":SYST:ERR?"), "-224,\"Illegal parameter value\"");
}

// Eight points of a sine of one turn, at 80 points a second.
TEST_F(Scpi, PlaysAnArbitraryWaveformAtTheVoltageThatIsSet) {
  std::string block = "#216";
  for (const int code : {8192, 13984, 16383, 13984, 8192, 2399, 0, 2399}) {
    block += static_cast<char>(code & 0xFF);
    block += static_cast<char>(code >> 8);
  }
  ask(":SOUR1:FUNC ARB");
  EXPECT_EQ(ask(":SYST:ERR?"), "-224,\"Illegal parameter value\""); // nothing is loaded yet
  ask(":SOURce1:VOLTage 0.4");
  ask(":SOURce1:TRACe:DATA:DAC16 VOLATILE,END," + block);
  ask(":SOURce1:FUNCtion:ARB:MODE SRATE");
  ask(":SOURce1:FUNCtion:ARB:SRATe 80");
  ask(":SOURce1:FUNCtion ARB");
  EXPECT_EQ(ask(":SYST:ERR?"), "0,\"No error\"");
  const auto line = [&] {
    return bench_.drive().lines.empty() ? DriveLine{} : bench_.drive().lines.front();
  };
  EXPECT_DOUBLE_EQ(line().frequency_hz, 10.0);
  EXPECT_NEAR(line().amplitude_v, 0.2, 1e-4);
  EXPECT_NEAR(line().phase_rad, 0.0, 1e-3);
  ask(":SOURce1:VOLTage 0");
  ask(":SOURce1:VOLTage 1.0");
  EXPECT_NEAR(line().amplitude_v, 0.5, 1e-4);
  ask(":SOURce1:TRACe:DATA:DAC16 VOLATILE,END,#9");
  EXPECT_EQ(ask(":SYST:ERR?"), "-161,\"Invalid block data\"");
  ask(":SOURce1:FUNCtion SINusoid");
  EXPECT_TRUE(bench_.drive().lines.empty());
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
