#include "analysis/step/frame_sine.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr std::int64_t frame_ns = 1'000'000'000;

std::optional<FrameSine> fit(const char* frequency_hz, std::int64_t off_from_ms = 1000,
                             std::int64_t off_to_ms = 1000) {
  std::vector<std::int64_t> stamps;
  std::vector<double> values;
  for (std::int64_t i = 0; i < 1000; ++i) {
    stamps.push_back(5 * frame_ns + 1'000'000 * i);
    const double angle = 2.0 * std::numbers::pi * 40.0 * (static_cast<double>(i) * 1e-3 - 0.5);
    const bool off = i >= off_from_ms && i < off_to_ms;
    values.push_back(off ? 7.0 : 7.0 + 2.0 * std::sin(angle + 0.3));
  }
  return fit_frame(*Frequency::parse(frequency_hz), 5 * frame_ns, frame_ns, stamps, values);
}

TEST(FrameSine, FindsAmplitudeAndPhaseAboutTheMiddle) {
  const auto found = fit("40");
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->amplitude, 2.0, 1e-12);
  EXPECT_NEAR(found->phase_rad, 0.3, 1e-12);
  EXPECT_LT(found->max_residual, 1e-12);
}

TEST(FrameSine, AnInterruptionShowsInNeighbouringSlices) {
  const auto whole = fit("40"), interrupted = fit("40", 400, 600);
  ASSERT_TRUE(whole && interrupted);
  EXPECT_LT(whole->max_neighbours_rms, 1e-12);
  EXPECT_GT(interrupted->max_neighbours_rms, 0.5);
  EXPECT_GT(interrupted->u_amplitude, 0.01);
}

TEST(FrameSine, ANeighbouringFrequencyLeavesResiduals) {
  const auto found = fit("43");
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(found->amplitude, 0.1);
  EXPECT_GT(found->residual_rms, 1.0);
}

TEST(FrameSine, IsEmptyAtHalfTheSampleRate) {
  EXPECT_FALSE(fit("500").has_value());
}

} // namespace
} // namespace dyncal::analysis
