#include "services/evaluation/record/clock_comparison.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

constexpr double frequency_hz = 80.0;
constexpr double rate_rel = 4e-5; // of the second clock

FoundExcitation excitation(double begin_s, double phase_rad, double clock_rel,
                           double amplitude = 1.0) {
  FoundExcitation one{.frame_ns = 100'000'000};
  const auto ns = [&](double true_s) { return std::llround(1e9 * (1.0 + clock_rel) * true_s); };
  one.window.excited_begin_ns = ns(begin_s);
  one.window.off_ns = ns(begin_s + 2.0);
  one.window.middle_ns = ns(begin_s + 1.0);
  one.window.phase_rad = phase_rad;
  one.window.u_phase_rad = 1e-3;
  one.window.frequency_hz = frequency_hz / (1.0 + clock_rel);
  one.window.u_frequency_rel = 1e-6;
  one.window.amplitude = amplitude;
  return one;
}

class ClockComparison : public testing::Test {
protected:
  [[nodiscard]] ExcitationInBoth both(std::size_t i, std::size_t j) const {
    return {&first_[i], &second_[j]};
  }
  std::array<FoundExcitation, 3> first_{excitation(1.0, 0.3, 0.0), excitation(4.0, -1.2, 0.0),
                                        excitation(7.0, 2.5, 0.0, 1.5)};
  std::array<FoundExcitation, 3> second_{excitation(1.0, 0.3, rate_rel, 0.2),
                                         excitation(4.0, -1.2, rate_rel, 0.2),
                                         excitation(7.0, 2.5, rate_rel, 0.3)};
};

TEST_F(ClockComparison, FindsTheRateFromTheFrequencies) {
  const ClockRate rate = clock_rate(std::array{both(0, 0), both(1, 1)});
  EXPECT_NEAR(rate.rel, rate_rel, 1e-12);
  EXPECT_NEAR(rate.u_rel, 1e-6, 1e-9);
}

TEST_F(ClockComparison, TheSameExcitationsAgreeInInstantsPhaseAndLevel) {
  const ClockRate rate = clock_rate(std::array{both(0, 0), both(2, 2)});
  EXPECT_TRUE(instants_agree(both(0, 0), both(2, 2), rate));
  EXPECT_EQ(phases_agree(both(0, 0), both(2, 2), rate), true);
  EXPECT_EQ(levels_agree(both(0, 0), both(2, 2)), true);
}

TEST_F(ClockComparison, OthersDoNot) {
  const ClockRate rate = clock_rate(std::array{both(0, 0)});
  EXPECT_FALSE(instants_agree(both(0, 0), both(1, 2), rate));
  EXPECT_EQ(phases_agree(both(0, 1), both(1, 2), rate), false);
  EXPECT_EQ(levels_agree(both(0, 1), both(1, 2)), false);
  EXPECT_TRUE(instants_agree(both(0, 1), both(1, 2), rate)) << "they are as far apart";
}

TEST_F(ClockComparison, AnEndThatWasCutOffDoesNotCount) {
  second_[1].window.excited_begin_ns += 1'500'000'000;
  EXPECT_TRUE(instants_agree(both(0, 0), both(1, 1), clock_rate(std::array{both(0, 0)})));
}

TEST_F(ClockComparison, PhasesTellNothingAcrossATimeThatIsTooLong) {
  ClockRate rate = clock_rate(std::array{both(0, 0)});
  rate.u_rel = 1e-3;
  EXPECT_EQ(phases_agree(both(0, 0), both(1, 1), rate), std::nullopt);
}

TEST_F(ClockComparison, PhasesOfOtherFrequenciesTellNothing) {
  first_[1].window.frequency_hz *= 1.001;
  const ClockRate rate{};
  EXPECT_EQ(phases_agree(both(0, 0), both(1, 1), rate), std::nullopt);
  EXPECT_EQ(levels_agree(both(0, 0), both(1, 1)), std::nullopt);
}

} // namespace
} // namespace dyncal::inline evaluation
