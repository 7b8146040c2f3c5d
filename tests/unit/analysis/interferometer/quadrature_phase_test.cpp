#include "analysis/interferometer/quadrature_phase.hpp"

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/analysis/interferometer/simulated_interferometer.hpp"

namespace dyncal::analysis {
namespace {

using simulated::Detectors;
using simulated::Motion;
using simulated::phase_turns;
using simulated::simulate;

// Largest deviation from the true phase, but for a constant and a slope of whole turns a sample.
double worst_turns(const Motion& motion, const std::vector<double>& turns) {
  double worst = 0.0;
  double slope = 0.0;
  double constant = 0.0;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const double truth = phase_turns(motion, static_cast<double>(i) / motion.sample_rate_hz, 0.0);
    const double difference = turns[i] - truth;
    if (i == 0) {
      constant = std::round(difference);
    } else if (i == 1) {
      slope = std::round(difference - constant);
    }
    worst = std::max(worst, std::abs(difference - constant - slope * static_cast<double>(i)));
  }
  return worst;
}

TEST(QuadraturePhase, FollowsTheMotionDownToSevenTenthsOfASampleAFringe) {
  for (const double rate_hz : {1e6, 2e5, 6e4, 3.6e4}) {
    Motion motion;
    motion.acceleration_m_s2 = 100.0;
    motion.sample_rate_hz = rate_hz;
    const auto signals = simulate(motion, {}, 1);
    QuadraturePhase phase(Detectors{}.ellipse);
    std::vector<double> turns(signals.u1.size());
    ASSERT_TRUE(phase.push(std::span(signals.u1), std::span(signals.u2), turns));
    EXPECT_EQ(phase.statistics().samples, turns.size());
    EXPECT_LT(worst_turns(motion, turns), 5e-3) << rate_hz;
    EXPECT_GT(worst_turns(motion, turns), 0.0);
  }
}

TEST(QuadraturePhase, CountsSamplesThatAreNearASlip) {
  Motion motion;
  motion.acceleration_m_s2 = 100.0;
  const auto count = [&](double rate_hz) {
    motion.sample_rate_hz = rate_hz;
    const auto signals = simulate(motion, {}, 1);
    QuadraturePhase phase(Detectors{}.ellipse);
    std::vector<double> turns(signals.u1.size());
    EXPECT_TRUE(phase.push(std::span(signals.u1), std::span(signals.u2), turns));
    return phase.statistics().doubtful;
  };
  EXPECT_EQ(count(2e6), 0u);
  EXPECT_GT(count(2.6e4), 100u); // sqrt(4 a / lambda) = 25.1 kS/s
}

TEST(QuadraturePhase, BlocksOfAnySizeGiveTheSameBits) {
  const auto signals = simulate({}, {}, 2);
  QuadraturePhase at_once(Detectors{}.ellipse);
  std::vector<double> expected(signals.u1.size());
  ASSERT_TRUE(at_once.push(std::span(signals.u1), std::span(signals.u2), expected));
  QuadraturePhase in_blocks(Detectors{}.ellipse);
  std::vector<double> turns(signals.u1.size());
  std::size_t begin = 0;
  for (std::size_t n = 1; begin < turns.size(); n = n * 2 + 1) {
    const std::size_t size = std::min(n, turns.size() - begin);
    ASSERT_TRUE(in_blocks.push(std::span(signals.u1).subspan(begin, size),
                               std::span(signals.u2).subspan(begin, size),
                               std::span(turns).subspan(begin, size)));
    begin += size;
  }
  EXPECT_EQ(turns, expected);
  EXPECT_EQ(in_blocks.statistics().radius_ratio(), at_once.statistics().radius_ratio());
  EXPECT_NEAR(at_once.statistics().turns_covered(),
              2.0 * 2.0 * 10.0 / std::pow(2.0 * std::numbers::pi * 160.0, 2) /
                  simulated::wavelength_m,
              0.05);
}

TEST(QuadraturePhase, SlowDetectorsLoseRadiusWhereFringesAreFast) {
  Motion motion;
  motion.acceleration_m_s2 = 100.0;
  auto signals = simulate(motion, {}, 3);
  const auto ratio = [&] {
    QuadraturePhase phase(Detectors{}.ellipse);
    std::vector<double> turns(signals.u1.size());
    EXPECT_TRUE(phase.push(std::span(signals.u1), std::span(signals.u2), turns));
    return phase.statistics().radius_ratio().value();
  };
  EXPECT_GT(ratio(), 0.98);
  const double keep = std::exp(-2.0 * std::numbers::pi * 3e5 / motion.sample_rate_hz);
  double low_passed[2] = {static_cast<double>(signals.u1[0]), static_cast<double>(signals.u2[0])};
  for (std::size_t i = 0; i < signals.u1.size(); ++i) {
    low_passed[0] = keep * low_passed[0] + (1.0 - keep) * signals.u1[i];
    low_passed[1] = keep * low_passed[1] + (1.0 - keep) * signals.u2[i];
    signals.u1[i] = static_cast<std::int16_t>(std::lround(low_passed[0]));
    signals.u2[i] = static_cast<std::int16_t>(std::lround(low_passed[1]));
  }
  EXPECT_LT(ratio(), smallest_radius_ratio);
}

// Offsets of another ellipse change the phase by parts of a turn; where it is adopted there is no
// step, whatever the velocity.
TEST(QuadraturePhase, GoesOnWhereItAdoptsAnotherEllipse) {
  for (const double rate_hz : {1e6, 6e4}) {
    Motion motion;
    motion.acceleration_m_s2 = 100.0;
    motion.sample_rate_hz = rate_hz;
    const auto signals = simulate(motion, Detectors{.noise_rel = 0.0}, 1);
    Ellipse rough = Detectors{}.ellipse;
    rough.p += 600.0;
    rough.alpha_rad = 0.0;
    QuadraturePhase phase(rough);
    const std::size_t half = signals.u1.size() / 2;
    std::vector<double> turns(signals.u1.size());
    const auto push = [&](std::size_t begin, std::size_t end) {
      ASSERT_TRUE(phase.push(std::span(signals.u1).subspan(begin, end - begin),
                             std::span(signals.u2).subspan(begin, end - begin),
                             std::span(turns).subspan(begin, end - begin)));
    };
    push(0, half);
    phase.adopt(Detectors{}.ellipse);
    push(half, turns.size());
    const double change = turns[half] - turns[half - 1] - (turns[half - 1] - turns[half - 2]);
    EXPECT_LT(std::abs(change), 0.2) << rate_hz;
    for (std::size_t i = half + 1; i + 1 < turns.size(); ++i) {
      const auto truth = [&](std::size_t k) {
        return phase_turns(motion, static_cast<double>(k) / rate_hz, 0.0);
      };
      ASSERT_NEAR(turns[i + 1] - 2.0 * turns[i] + turns[i - 1],
                  truth(i + 1) - 2.0 * truth(i) + truth(i - 1), 1e-3);
    }
  }
}

TEST(QuadraturePhase, ExpectsNothingWhereItBeginsAgain) {
  const Motion motion;
  const auto signals = simulate(motion, Detectors{}, 2);
  QuadraturePhase phase(Detectors{}.ellipse);
  std::vector<double> turns(signals.u1.size());
  ASSERT_TRUE(phase.push(signals.u1, signals.u2, turns));
  EXPECT_EQ(phase.statistics().doubtful, 0U);
  phase.forget_extremes();
  EXPECT_FALSE(phase.statistics().radius_ratio());
  EXPECT_EQ(phase.statistics().turns_covered(), 0.0);
  phase.begin_again(); // with signals of another velocity
  ASSERT_TRUE(phase.push(std::span(signals.u1).subspan(3000), std::span(signals.u2).subspan(3000),
                         std::span(turns).subspan(3000)));
  EXPECT_EQ(phase.statistics().doubtful, 0U);
  EXPECT_GT(phase.statistics().turns_covered(), 1.0);
}

TEST(QuadraturePhase, NamesTheSampleThatIsNotFinite) {
  std::vector<float> u(3000, 1.0F);
  u[2345] = std::numeric_limits<float>::quiet_NaN();
  QuadraturePhase phase({});
  std::vector<double> turns(u.size());
  const auto pushed = phase.push(std::span<const float>(u), std::span<const float>(u), turns);
  ASSERT_FALSE(pushed);
  EXPECT_NE(pushed.error().message.find("sample 2345 "), std::string::npos)
      << pushed.error().message;
}

} // namespace
} // namespace dyncal::analysis
