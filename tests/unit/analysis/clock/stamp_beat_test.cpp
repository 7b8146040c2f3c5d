#include "analysis/clock/stamp_beat.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {
namespace {

constexpr int samples = 1500;
constexpr double pi = 3.14159265358979323846;

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
};

// A regular sensor of this period; the stamps are the last ticks.
Record ticked(double period_s, double tick_s, double frequency_hz) {
  Record record;
  for (int i = 0; i < samples; ++i) {
    const double t = 0.0123 + i * period_s;
    record.stamps_ns.push_back(std::llround(1e9 * tick_s * std::floor(t / tick_s)));
    record.values.push_back(std::sin(2.0 * pi * frequency_hz * t));
  }
  return record;
}

double amplitude_error(const Record& record, const Frequency& frequency) {
  const std::span<const double> channel[] = {record.values};
  return fit_sine(frequency, 0, record.stamps_ns, channel)->front().amplitude() - 1.0;
}

// Periods are drawn so that the fourth harmonic of the saw-tooth is 0.02 to 0.3 Hz beside 2 f.
TEST(StampBeat, BoundsWhatTicksInStepWithTheSineDoToItsAmplitude) {
  std::mt19937_64 random(23);
  const auto frequency = *Frequency::parse("63");
  double largest = 0.0;
  for (int draw = 0; draw < 50; ++draw) {
    const double beside_hz = std::uniform_real_distribution(0.02, 0.3)(random);
    const double slip_hz = (126.0 + beside_hz) / 4.0;      // of the tick against the samples
    const double period_s = 1e-3 / (1.0 + slip_hz * 1e-4); // ten ticks, less 1e-4 slip_hz of one
    const Record record = ticked(period_s, 1e-4, 63.0);
    const double shortened = std::pow(2.0 * pi * 63.0 * 1e-4, 2) / 24.0;
    const double error = std::abs(amplitude_error(record, frequency) + shortened);
    const double bound = frequency.angular() * stamp_beat_s(frequency, record.stamps_ns);
    EXPECT_LE(error, bound + 2e-5) << "draw " << draw;
    largest = std::max(largest, error);
  }
  EXPECT_GT(largest, 5e-4); // there was something to bound
}

TEST(StampBeat, IsNoneOfStampsThatScatterFreelyOrAreRegular) {
  std::mt19937_64 random(24);
  const auto frequency = *Frequency::parse("63");
  for (int draw = 0; draw < 200; ++draw) {
    std::normal_distribution<double> normal(0.0, draw % 2 == 0 ? 2e-6 : 0.0);
    std::vector<std::int64_t> stamps_ns;
    for (int i = 0; i < samples; ++i) {
      stamps_ns.push_back(std::llround(1e9 * (i * 0.997e-3 + normal(random))));
    }
    EXPECT_EQ(stamp_beat_s(frequency, stamps_ns), 0.0) << "draw " << draw;
  }
}

TEST(StampBeat, FollowsSamplesThatWereLost) {
  const auto frequency = *Frequency::parse("63");
  const Record whole = ticked(0.99686e-3, 1e-4, 63.0);
  std::vector<std::int64_t> lossy;
  for (std::size_t i = 0; i < whole.stamps_ns.size(); ++i) {
    if (i % 97 != 5) {
      lossy.push_back(whole.stamps_ns[i]);
    }
  }
  const double beat_s = stamp_beat_s(frequency, whole.stamps_ns);
  ASSERT_GT(beat_s, 1e-6);
  EXPECT_NEAR(stamp_beat_s(frequency, lossy), beat_s, 0.1 * beat_s);
}

TEST(StampBeat, IsNotToldByFewStampsOrIntervalsThatTellNoNumbers) {
  const auto frequency = *Frequency::parse("63");
  const std::vector<std::int64_t> few{0, 1'000'000, 2'000'000};
  EXPECT_EQ(stamp_beat_s(frequency, few), 0.0);
  std::vector<std::int64_t> batches;
  for (int i = 0; i < samples; ++i) {
    batches.push_back(1'000'000LL * (i / 2) + 450'000LL * (i % 2));
  }
  EXPECT_EQ(stamp_beat_s(frequency, batches), 0.0);
}

} // namespace
} // namespace dyncal::analysis
