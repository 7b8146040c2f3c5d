#include "drivers/virtual_bench/model/trigger_model.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dyncal::drivers::virtual_bench {
namespace {

class TriggerModelTest : public testing::Test {
protected:
  void drive(double frequency_hz, bool rectangle = false) {
    excitation_.change(0.0, {frequency_hz, 0.1, true, rectangle});
    frequency_hz_ = frequency_hz;
  }
  TriggerEvent event_after(double from_s) {
    for (double until_s = from_s + 0.02; until_s < from_s + 2.0; until_s += 0.02) {
      if (const auto event = model_.first_between(from_s, until_s, 0.0, excitation_)) {
        return *event;
      }
    }
    ADD_FAILURE() << "no trigger";
    return {};
  }
  // Phase of sync at the trigger, in rad, -pi..pi.
  double phase_at(double time_s) const {
    const Motion motion = excitation_.motion(time_s);
    return std::atan2(motion.sine, motion.cosine);
  }

  Excitation excitation_{ExciterModel{}};
  TriggerModel model_{TriggerSettings{}};
  double frequency_hz_ = 0.0;
};

TEST_F(TriggerModelTest, NoiseMakesTheTriggerComeEarlyByTensOfMilliradians) {
  for (const double frequency_hz : {10.0, 200.0}) {
    drive(frequency_hz);
    double sum = 0.0;
    double squares = 0.0;
    constexpr int shots = 200;
    for (int shot = 0; shot < shots; ++shot) {
      const double phase = phase_at(event_after(0.5 + 0.0137 * shot).trigger_s);
      sum += phase;
      squares += phase * phase;
    }
    const double mean = sum / shots;
    EXPECT_LT(mean, -0.012) << frequency_hz;
    EXPECT_GT(mean, -0.04) << frequency_hz;
    EXPECT_GT(std::sqrt(squares / shots - mean * mean), 5e-4)
        << frequency_hz; // it scatters as well
  }
}

TEST_F(TriggerModelTest, TheOutputFollowsTheTriggerBy236Nanoseconds) {
  drive(100.0);
  double sum_s = 0.0;
  constexpr int shots = 100;
  for (int shot = 0; shot < shots; ++shot) {
    const TriggerEvent event = event_after(0.5 + 0.0137 * shot);
    sum_s += event.output_edge_s - event.trigger_s;
  }
  EXPECT_NEAR(sum_s / shots, 236e-9, 0.4e-9); // 1 ns from shot to shot
}

TEST_F(TriggerModelTest, ARectangleTriggersWhereItRises) {
  drive(1000.0, true);
  const TriggerEvent event = event_after(0.5);
  EXPECT_NEAR(phase_at(event.trigger_s) / (2.0 * std::numbers::pi * frequency_hz_), 0.0, 1e-9);
}

TEST_F(TriggerModelTest, NothingTriggersWhileTheGeneratorIsOff) {
  excitation_.change(0.0, {10.0, 0.1, false, false});
  EXPECT_FALSE(model_.first_between(0.1, 5.0, 0.0, excitation_).has_value());
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
