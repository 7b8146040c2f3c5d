#include "services/bench/file/measuring_chain.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline bench {
namespace {

using analysis::ReferenceCalibrationPoint;
using testing::HasSubstr;

ReferenceCalibrationPoint point(double frequency_hz, double magnitude, double phase_rad,
                                double u_magnitude_rel, double u_phase_rad) {
  return {frequency_hz,
          0.0,
          magnitude,
          phase_rad,
          {{.u_magnitude_rel = u_magnitude_rel, .u_phase_rad = u_phase_rad}}};
}

// 0.13 pC/(m/s^2), 1 mV/pC within 0.4 %, read with 0.1305 mV/(m/s^2).
MeasuringChain charge_chain() {
  return {.transducer = {*parse_sensitivity_unit("pC/(m/s^2)"),
                         {point(10.0, 0.13017, -0.0003, 1e-3, 2e-3),
                          point(1000.0, 0.13033, 0.0002, 1e-3, 2e-3)}},
          .amplifier =
              StatedResponse{
                  *parse_sensitivity_unit("mV/pC"),
                  {point(1.0, 1.0, 0.01, 2e-3, 1e-3), point(10.0, 1.001, 0.001, 2e-3, 1e-3),
                   point(1000.0, 0.999, -0.02, 2e-3, 1e-3), point(5000.0, 0.99, -0.1, 2e-3, 1e-3)}},
          .channel_unit = *parse_sensitivity_unit("mV/(m/s^2)"),
          .channel_sensitivity = 0.1305};
}

TEST(MeasuringChain, IsTransducerTimesAmplifierOverTheChannel) {
  const auto points = response_of(charge_chain());
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 2U); // where both hold
  EXPECT_NEAR(points->at(0).magnitude, 0.13017 * 1.001 / 0.1305, 1e-12);
  EXPECT_NEAR(points->at(0).phase_rad, -0.0003 + 0.001, 1e-12);
  EXPECT_NEAR(points->at(1).magnitude, 0.13033 * 0.999 / 0.1305, 1e-12);
  const auto& contributions = points->at(0).contributions;
  ASSERT_EQ(contributions.size(), 3U);
  EXPECT_EQ(contributions[0].name, "");
  EXPECT_NEAR(contributions[0].u_magnitude_rel, 1e-3, 1e-15);
  EXPECT_EQ(contributions[1].name, "amplifier");
  EXPECT_NEAR(contributions[1].u_magnitude_rel, 2e-3, 1e-15);
  EXPECT_NEAR(contributions[1].u_phase_rad, 1e-3, 1e-15);
}

// What the amplifier does between two frequencies of the transducer is in the chain.
TEST(MeasuringChain, HasTheFrequenciesOfBothTables) {
  MeasuringChain chain = charge_chain();
  chain.amplifier->points.push_back(point(100.0, 1.05, 0.0, 2e-3, 1e-3));
  const auto points = response_of(chain);
  ASSERT_TRUE(points);
  ASSERT_EQ(points->size(), 3U);
  EXPECT_EQ(points->at(1).frequency_hz, 100.0);
  EXPECT_NEAR(points->at(1).magnitude, 0.1302 * 1.05 / 0.1305, 2e-4);
  EXPECT_EQ(points->at(1).contributions.back().name, "frequencies of the certificates");
}

TEST(MeasuringChain, HoldsEveryGainAgainstG) {
  MeasuringChain chain = charge_chain();
  chain.amplifier.reset();
  chain.transducer.unit = *parse_sensitivity_unit("mV/g");
  for (ReferenceCalibrationPoint& one : chain.transducer.points) {
    one.magnitude *= 9.80665;
  }
  const auto points = response_of(chain);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_NEAR(points->at(0).magnitude, 0.13017 / 0.1305, 1e-12);
}

// A transducer with a voltage may have an amplifier as well.
TEST(MeasuringChain, TakesTheGainOfAVoltage) {
  MeasuringChain chain = charge_chain();
  chain.transducer.unit = *parse_sensitivity_unit("mV/(m/s^2)");
  chain.amplifier =
      StatedResponse{*parse_sensitivity_unit("V/V"),
                     {point(1.0, 10.0, 0.0, 1e-3, 1e-3), point(5000.0, 10.0, 0.0, 1e-3, 1e-3)}};
  chain.channel_sensitivity = 1.305;
  const auto points = response_of(chain);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_NEAR(points->front().magnitude, 0.13017 * 10.0 / 1.305, 1e-12);
}

TEST(MeasuringChain, RefusesWhatDoesNotFit) {
  const auto problem_of = [](const MeasuringChain& chain) {
    const auto points = response_of(chain);
    return points ? std::string() : points.error().message;
  };
  MeasuringChain chain = charge_chain();
  chain.amplifier.reset();
  EXPECT_THAT(problem_of(chain), HasSubstr("a charge needs the table [amplifier]"));
  chain = charge_chain();
  chain.amplifier->unit = *parse_sensitivity_unit("mV/g");
  EXPECT_THAT(problem_of(chain), HasSubstr("the output of the transducer is in C"));
  chain = charge_chain();
  chain.channel_sensitivity = 130.5; // uV taken for mV
  EXPECT_THAT(problem_of(chain), HasSubstr("times what is"));
  chain = charge_chain();
  chain.channel_unit = *parse_sensitivity_unit("mV/(m/s)");
  EXPECT_THAT(problem_of(chain), HasSubstr("what the transducer measures is in m/s^2"));
  chain = charge_chain();
  chain.amplifier->points = {point(2000.0, 1.0, 0.0, 0.0, 0.0), point(3000.0, 1.0, 0.0, 0.0, 0.0)};
  EXPECT_THAT(problem_of(chain), HasSubstr("no frequency in common"));
}

} // namespace
} // namespace dyncal::inline bench
