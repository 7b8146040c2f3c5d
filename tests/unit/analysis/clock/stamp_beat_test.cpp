#include "analysis/clock/stamp_beat.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {
namespace {

constexpr int samples = 1500;
constexpr double pi = std::numbers::pi;

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
};

// A regular sensor of this period; the stamps are the middles of ticks, so that errors are none on
// average but for what a slow saw-tooth leaves.
Record ticked(double period_s, double tick_s, double frequency_hz, double begin_s = 0.0123,
              double phase_rad = 0.0) {
  Record record;
  for (int i = 0; i < samples; ++i) {
    const double t = begin_s + i * period_s;
    record.stamps_ns.push_back(std::llround(1e9 * tick_s * (std::floor(t / tick_s) + 0.5)));
    record.values.push_back(std::sin(2.0 * pi * frequency_hz * t + phase_rad));
  }
  return record;
}

SineFit fitted(const Record& record, const Frequency& frequency) {
  const std::span<const double> channel[] = {record.values};
  return fit_sine(frequency, 0, record.stamps_ns, channel)->front();
}

double in_step_rad(const Frequency& frequency, const std::vector<std::int64_t>& stamps_ns) {
  return stamp_beat(frequency, stamps_ns).in_step_rad;
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
    const double error = std::abs(fitted(record, frequency).amplitude() - 1.0 + shortened);
    EXPECT_LE(error, in_step_rad(frequency, record.stamps_ns) + 2e-5) << "draw " << draw;
    largest = std::max(largest, error);
  }
  EXPECT_GT(largest, 5e-4); // there was something to bound
}

// Of two channels with the same stamps, with ticks of up to half a period, wherever they beat.
TEST(StampBeat, BoundsThePhaseBetweenTwoSines) {
  std::mt19937_64 random(25);
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution(from, to)(random);
  };
  double largest_rad = 0.0;
  int drawn = 0;
  for (const double tick_s : {1e-4, 2e-4, 5e-4}) {
    for (const char* text : {"20", "31.5", "40", "80"}) {
      for (int draw = 0; draw < 20; ++draw, ++drawn) {
        const auto frequency = *Frequency::parse(text);
        const double period_s = 1e-3 * uniform(0.99, 1.01);
        const double begin_s = uniform(0.0, 1e-3);
        const Record one = ticked(period_s, tick_s, frequency.hz(), begin_s);
        const Record other = ticked(period_s, tick_s, frequency.hz(), begin_s, 0.5 * pi);
        const double between_rad =
            fitted(other, frequency).phase_rad() - fitted(one, frequency).phase_rad();
        const double error_rad = std::abs(std::remainder(between_rad - 0.5 * pi, 2.0 * pi));
        const double bound_rad = 2.0 * in_step_rad(frequency, one.stamps_ns);
        EXPECT_LE(error_rad, 1.1 * bound_rad + 1e-4)
            << text << " Hz, tick " << tick_s << ", period " << period_s;
        largest_rad = std::max(largest_rad, error_rad);
      }
    }
  }
  EXPECT_EQ(drawn, 240);
  EXPECT_GT(largest_rad, 1e-3);
}

// Also where a saw-tooth takes longer than the record: then no more than half a tick is known.
TEST(StampBeat, BoundsTheMeanErrorOfTicks) {
  std::mt19937_64 random(26);
  double largest_s = 0.0, largest_of_quick_s = 0.0;
  for (int draw = 0; draw < 100; ++draw) {
    const bool is_slow = draw % 2 == 0;
    const double beside = std::uniform_real_distribution(-1.0, 1.0)(random);
    const double period_s = is_slow ? 1e-3 + 1e-7 * beside : 0.997e-3 + 1e-6 * beside;
    const double begin_s = std::uniform_real_distribution(0.0, 1e-3)(random);
    const Record record = ticked(period_s, 2.5e-4, 40.0, begin_s);
    double mean_s = 0.0;
    for (int i = 0; i < samples; ++i) {
      const double t = begin_s + i * period_s;
      mean_s +=
          (1e-9 * static_cast<double>(record.stamps_ns[static_cast<std::size_t>(i)]) - t) / samples;
    }
    const StampBeat beat = stamp_beat(*Frequency::parse("40"), record.stamps_ns, 2.5e-4);
    EXPECT_LE(std::abs(mean_s), beat.mean_s + 1e-9) << "draw " << draw;
    EXPECT_LE(beat.mean_s, 1.25e-4) << "draw " << draw;
    largest_s = std::max(largest_s, std::abs(mean_s));
    largest_of_quick_s = std::max(largest_of_quick_s, is_slow ? 0.0 : beat.mean_s);
  }
  EXPECT_GT(largest_s, 5e-5);
  EXPECT_LT(largest_of_quick_s, 2e-5);
}

TEST(StampBeat, TakesTheStatedTickWhereAllIntervalsAreAlike) {
  std::vector<std::int64_t> stamps_ns;
  for (int i = 0; i < samples; ++i) {
    stamps_ns.push_back(1'000'000LL * i);
  }
  const auto frequency = *Frequency::parse("40");
  EXPECT_DOUBLE_EQ(stamp_beat(frequency, stamps_ns, 2.5e-4).mean_s, 1.25e-4);
  EXPECT_EQ(stamp_beat(frequency, stamps_ns, 9.3e-9).mean_s, 0.0); // as good as none
  EXPECT_EQ(stamp_beat(frequency, stamps_ns).mean_s, 0.0);
  stamps_ns.erase(stamps_ns.begin() + 700); // a sample that is missing is no tick
  EXPECT_EQ(stamp_beat(frequency, stamps_ns).mean_s, 0.0);
  EXPECT_EQ(stamp_beat(frequency, stamps_ns).in_step_rad, 0.0);
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
    const StampBeat beat = stamp_beat(frequency, stamps_ns);
    EXPECT_EQ(beat.in_step_rad, 0.0) << "draw " << draw;
    EXPECT_EQ(beat.mean_s, 0.0) << "draw " << draw;
  }
}

TEST(StampBeat, FollowsSamplesThatWereLost) {
  const auto frequency = *Frequency::parse("63");
  for (const double tick_s : {1e-4, 5e-4}) {
    const Record whole = ticked(0.99686e-3, tick_s, 63.0);
    std::vector<std::int64_t> lossy;
    for (std::size_t i = 0; i < whole.stamps_ns.size(); ++i) {
      if (i % 97 != 5) {
        lossy.push_back(whole.stamps_ns[i]);
      }
    }
    const double beat_rad = in_step_rad(frequency, whole.stamps_ns);
    ASSERT_GT(beat_rad, 4e-4);
    EXPECT_NEAR(in_step_rad(frequency, lossy), beat_rad, 0.25 * beat_rad) << tick_s;
  }
}

TEST(StampBeat, IsNotToldByFewStampsOrIntervalsThatTellNoNumbers) {
  const auto frequency = *Frequency::parse("63");
  const std::vector<std::int64_t> few{0, 1'000'000, 2'000'000};
  EXPECT_EQ(in_step_rad(frequency, few), 0.0);
  std::mt19937_64 random(27);
  std::vector<std::int64_t> poisson{0}; // as events come that nothing clocks
  for (int i = 0; i < samples; ++i) {
    const double wait_ns = std::exponential_distribution(1e-6)(random);
    poisson.push_back(poisson.back() + 1 + std::llround(wait_ns));
  }
  EXPECT_EQ(in_step_rad(frequency, poisson), 0.0);
}

} // namespace
} // namespace dyncal::analysis
