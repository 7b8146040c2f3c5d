#include "analysis/sine/sine_values.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/analysis/sine/sine_signal.hpp"

namespace dyncal::analysis {
namespace {

// More than one block of the kernel, and not a whole number of its lanes.
TEST(SineValues, AreThoseOfTheReducedPhase) {
  const Frequency frequency = *Frequency::parse("199.87");
  auto stamps = uneven_stamps(1203);
  std::swap(stamps[3], stamps[900]);                           // the order does not matter
  const std::int64_t origin_ns = epoch_ns - 3'600'000'000'000; // an hour before
  std::vector<double> sine(stamps.size()), cosine(stamps.size());
  fill_sine_cosine(frequency, origin_ns, stamps, sine.data(), cosine.data());
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const double angle = 2.0 * std::numbers::pi * frequency.reduced_turns(stamps[i] - origin_ns);
    EXPECT_NEAR(sine[i], std::sin(angle), 1e-15) << i;
    EXPECT_NEAR(cosine[i], std::cos(angle), 1e-15) << i;
  }
}

TEST(SineValues, NoStampsNeedNoRoom) {
  fill_sine_cosine(*Frequency::parse("80"), 0, {}, nullptr, nullptr);
  double sine = 7.0, cosine = 7.0;
  const std::vector<std::int64_t> one{5};
  fill_sine_cosine(*Frequency::parse("80"), 5, one, &sine, &cosine);
  EXPECT_EQ(sine, 0.0);
  EXPECT_EQ(cosine, 1.0);
}

} // namespace
} // namespace dyncal::analysis
