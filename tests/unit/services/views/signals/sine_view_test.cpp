#include "services/views/signals/sine_view.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dyncal::inline views {
namespace {

std::vector<Sample> sine(std::size_t count) {
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s = static_cast<double>(i) * 1e-3;
    samples.push_back({static_cast<std::int64_t>(i) * 1'000'000 + 1'700'000'000'000'000'000,
                       3.0 * std::sin(2.0 * std::numbers::pi * 16.0 * time_s) + 0.5});
  }
  samples[count / 2].value += 0.01;
  return samples;
}

TEST(SineView, FitsTheExcitationAndShowsWhatItLeaves) {
  const auto samples = sine(2000);
  const auto view = view_sine({samples, *analysis::Frequency::parse("16"), 0.0}, 100);
  ASSERT_TRUE(view);
  EXPECT_NEAR(view->fit.amplitude(), 3.0, 1e-4);
  EXPECT_NEAR(view->fit.offset, 0.5, 1e-4);
  EXPECT_NEAR(view->residual_rms, 0.01 / std::sqrt(2000.0), 1e-6);
  double largest = 0.0;
  for (const TraceColumn& column : view->residuals) {
    largest = std::max(largest, column.maximum);
  }
  EXPECT_NEAR(largest, 0.01, 1e-4) << "one sample that is off shows";
  EXPECT_LE(view->residuals.size(), 100U);
  EXPECT_NEAR(view->columns.back().time_s, 0.25, 0.02) << "four periods";
}

TEST(SineView, StatesTheScatterFromBlockToBlock) {
  const auto samples = sine(2000);
  const auto view = view_sine({samples, *analysis::Frequency::parse("16"), 0.02}, 100);
  ASSERT_TRUE(view);
  EXPECT_NEAR(view->fit.u_amplitude(), 0.02, 1e-4);
}

} // namespace
} // namespace dyncal::inline views
