#include "drivers/generator/arbitrary_waveform.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::drivers::generator {
namespace {

using testing::HasSubstr;

constexpr const char* rigol = "Rigol Technologies,DG1032Z,DG1ZA000000001,03.01.12";

TEST(ArbitraryWaveform, HasItsPeakAtTheEndsOfTheConverter) {
  const std::vector<double> samples{0.0, 0.5, -0.5, 0.25, 0.0, 0.0, 0.0, 0.0};
  const auto loaded = load_waveform(rigol, samples, 3276.8);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->peak_v, 0.5);
  ASSERT_EQ(loaded->commands.size(), 4U);
  EXPECT_EQ(loaded->commands[0].text, ":SOURce1:TRACe:DATA:DAC16 VOLATILE,END");
  const std::string& block = loaded->commands[0].block;
  EXPECT_TRUE(block.starts_with(",#500016"));
  ASSERT_EQ(block.size(), 8U + 16U);
  const auto code = [&](std::size_t i) {
    return static_cast<unsigned char>(block[8 + 2 * i]) |
           static_cast<unsigned char>(block[9 + 2 * i]) << 8;
  };
  EXPECT_EQ(code(0), 8192); // 8191.5, rounded
  EXPECT_EQ(code(1), 0x3FFF);
  EXPECT_EQ(code(2), 0);
  EXPECT_EQ(code(3), 12287);
  EXPECT_EQ(loaded->commands[2].text, ":SOURce1:FUNCtion:ARB:SRATe 3276.8");
}

TEST(ArbitraryWaveform, GoesInPacketsOfWhichTheLastSaysSo) {
  const std::vector<double> samples(40'000, 1.0);
  const auto loaded = load_waveform(rigol, samples, 4000.0);
  ASSERT_TRUE(loaded);
  ASSERT_EQ(loaded->commands.size(), 6U);
  EXPECT_TRUE(loaded->commands[0].text.ends_with("CON"));
  EXPECT_TRUE(loaded->commands[0].block.starts_with(",#532768"));
  EXPECT_TRUE(loaded->commands[1].text.ends_with("CON"));
  EXPECT_TRUE(loaded->commands[2].text.ends_with("END"));
  EXPECT_TRUE(loaded->commands[2].block.starts_with(",#514464"));
}

TEST(ArbitraryWaveform, IsRefusedByNameWhereNobodyKnowsHowToLoadIt) {
  const std::vector<double> samples(100, 1.0);
  for (const char* able :
       {"Rigol Technologies,DG812,DG8A1,00.02.06", "RIGOL TECHNOLOGIES,DG992,DG9A1,00.02.06",
        "Rigol Technologies,DG1062Z,DG1ZA1,03.01.12", "dyncal virtual bench,mpu9250-ptb,1,1"}) {
    EXPECT_TRUE(load_waveform(able, samples, 10.0)) << able;
  }
  for (const char* other :
       {"Rigol Technologies,DG4162,DG4E1,00.01.14", "Rigol Technologies,DG1022,DG1D1,00.02",
        "Keysight Technologies,33512B,dyncal virtual bench mpu9250-ptb,1", "Somebody,X1,1,1"}) {
    const auto refused = load_waveform(other, samples, 10.0);
    ASSERT_FALSE(refused) << other;
    EXPECT_EQ(refused.error().code, ErrorCode::refused);
    EXPECT_THAT(refused.error().message, HasSubstr(std::string(other).substr(0, 40)));
  }
}

TEST(ArbitraryWaveform, RefusesWhatIsNone) {
  std::vector<double> samples(100, 0.0);
  EXPECT_THAT(load_waveform(rigol, samples, 10.0).error().message, HasSubstr("0 throughout"));
  samples[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(load_waveform(rigol, samples, 10.0).error().message, HasSubstr("is none"));
  samples.assign(7, 1.0);
  EXPECT_FALSE(load_waveform(rigol, samples, 10.0));
  samples.assign(100, 1.0);
  EXPECT_FALSE(load_waveform(rigol, samples, 0.0));
}

} // namespace
} // namespace dyncal::drivers::generator
