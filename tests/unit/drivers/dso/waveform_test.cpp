#include "drivers/dso/waveform.hpp"

#include <gtest/gtest.h>

namespace dyncal::drivers::dso {
namespace {

TEST(Waveform, APreambleGivesTheTimeOfTheFirstSampleRelativeToTheTrigger) {
  const auto preamble =
      parse_preamble("0,2,1000,1,1.000000E-07,-5.000000E-05,0,4.000000E-02,0,128");
  ASSERT_TRUE(preamble.has_value()) << preamble.error().message;
  EXPECT_EQ(preamble->points, 1000U);
  EXPECT_DOUBLE_EQ(preamble->first_sample_s(), -5e-5);
  EXPECT_DOUBLE_EQ(preamble->x_increment_s, 1e-7);
}

TEST(Waveform, APreambleThatCannotBeIsRefused) {
  for (const char* answer : {"", "0,2,1000,1,1E-7,0,0,0.04,0", "0,2,1000,1,1E-7,0,0,0.04,0,128,1",
                             "1,2,1000,1,1E-7,0,0,0.04,0,128", "0,2,0,1,1E-7,0,0,0.04,0,128",
                             "0,2,10.5,1,1E-7,0,0,0.04,0,128", "0,2,1000,1,0,0,0,0.04,0,128",
                             "0,2,1000,1,1E-7,0,0,-0.04,0,128", "0,2,1E12,1,1E-7,0,0,0.04,0,128",
                             "0,2,1000,1,nan,0,0,0.04,0,128"}) {
    const auto preamble = parse_preamble(answer);
    EXPECT_FALSE(preamble.has_value()) << answer;
  }
}

TEST(Waveform, VoltsFollowTheRuleOfTheFamily) {
  Preamble preamble;
  preamble.y_increment_v = 0.04;
  preamble.y_origin = 10.0;
  preamble.y_reference = 128.0;
  const char codes[] = {static_cast<char>(0), static_cast<char>(138), static_cast<char>(255)};
  std::vector<double> volts;
  append_volts(preamble, VoltageRule::rigol, codes, volts);
  ASSERT_EQ(volts.size(), 3U);
  EXPECT_DOUBLE_EQ(volts[0], -138.0 * 0.04);
  EXPECT_DOUBLE_EQ(volts[1], 0.0);
  EXPECT_DOUBLE_EQ(volts[2], 117.0 * 0.04);

  preamble.y_origin = 1.5; // volt at the reference code
  volts.clear();
  append_volts(preamble, VoltageRule::keysight, codes, volts);
  EXPECT_DOUBLE_EQ(volts[1], 10.0 * 0.04 + 1.5);
}

} // namespace
} // namespace dyncal::drivers::dso
