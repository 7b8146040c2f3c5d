#include "analysis/sine/frequency_estimate.hpp"

#include <array>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/analysis/sine/sine_signal.hpp"

namespace dyncal::analysis {
namespace {

Expected<Frequency> estimate(const std::vector<std::int64_t>& stamps,
                             const std::vector<double>& values) {
  const std::array<std::span<const double>, 1> columns{values};
  return estimate_frequency(stamps, columns);
}

TEST(FrequencyEstimate, IsGoodToATenthOfABin) {
  const auto stamps = uneven_stamps(2000);
  for (const char* text : {"1.7", "80", "199.87", "431.3"}) {
    const Signal signal{.frequency_hz = text};
    const auto found = estimate(stamps, noisy(values_of(signal, stamps), 0.05, 1));
    ASSERT_TRUE(found.has_value()) << text << ": " << found.error().message;
    EXPECT_NEAR(found->hz(), std::stod(text), 0.1 * 0.5) << text; // a bin is 0.5 Hz
  }
}

TEST(FrequencyEstimate, GapsStayEmpty) {
  auto stamps = uneven_stamps(2000);
  stamps.erase(stamps.begin() + 700, stamps.begin() + 1100);
  const auto found = estimate(stamps, values_of(Signal{}, stamps));
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->hz(), 80.0, 0.25); // half a bin: the search of the fit finds it from there
}

TEST(FrequencyEstimate, RefusesWhatHasNoFrequency) {
  const auto stamps = uneven_stamps(100);
  EXPECT_EQ(estimate(stamps, std::vector<double>(100, 2.0)).error().code, ErrorCode::no_excitation);
  EXPECT_EQ(estimate({1, 2, 3}, {0.0, 1.0, 0.0}).error().code, ErrorCode::too_few_samples);
  EXPECT_EQ(estimate(stamps, std::vector<double>(99, 2.0)).error().code,
            ErrorCode::invalid_argument);
  auto values = values_of(Signal{}, stamps);
  values[50] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(estimate(stamps, values).error().code, ErrorCode::not_finite);
  auto backwards = stamps;
  std::swap(backwards[10], backwards[11]);
  EXPECT_EQ(estimate(backwards, values_of(Signal{}, stamps)).error().code,
            ErrorCode::stamps_not_increasing);
}

} // namespace
} // namespace dyncal::analysis
