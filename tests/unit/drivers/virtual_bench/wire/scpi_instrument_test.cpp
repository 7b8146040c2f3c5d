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

} // namespace
} // namespace dyncal::drivers::virtual_bench
