#include "analysis/step/peak_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/step/signal_integrity.hpp"

namespace dyncal::analysis {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();

struct Channel {
  double frequency_hz = 80.3;
  double rate_hz = 1003.05;
  double noise = 0.001;
  double upper = none; // ends, of the amplitude
  double lower = none;
  double delay_rad = 0.3;
  std::vector<double> harmonics{0.001, 0.0005}; // of the exciter, second, third ...
  std::vector<double> own{};                    // of the channel itself
  std::size_t mean_of = 1;                      // samples of its filter, behind the ends
  double seconds = 1.5;
  double modulated = 0.0; // of the level, at `by_hz`
  double by_hz = 3.3;
  int derivative = 0;         // of the motion that the reference reads
  double per_order_rad = 1.7; // phases of the exciter's harmonics
  double first_rad = 0.0;
};

SineShape shape_of(const Channel& channel, double exciter_phase, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0.0, 1.0);
  const auto sine = [&](double t) {
    const double turn =
        2.0 * std::numbers::pi * channel.frequency_hz * t + exciter_phase - channel.delay_rad;
    const double ahead = 0.5 * std::numbers::pi * channel.derivative;
    double value = std::sin(turn + ahead);
    for (std::size_t k = 0; k < channel.harmonics.size(); ++k) {
      const double order = static_cast<double>(k + 2);
      value += channel.harmonics[k] * std::pow(order, channel.derivative) *
               std::sin(order * turn + channel.per_order_rad * order + channel.first_rad + ahead);
    }
    for (std::size_t k = 0; k < channel.own.size(); ++k) {
      const double order = static_cast<double>(k + 2);
      value += channel.own[k] * std::sin(order * turn + 0.5 * std::numbers::pi * (order - 1.0));
    }
    const double level =
        1.0 + channel.modulated * std::sin(2.0 * std::numbers::pi * channel.by_hz * t);
    return std::clamp(level * value, -channel.lower, channel.upper);
  };
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  const double n = static_cast<double>(channel.mean_of);
  for (double i = 0.0; i < channel.seconds * channel.rate_hz; i += 1.0) {
    double value = 0.0;
    for (double k = 0.0; k < n; k += 1.0) {
      value += sine((i + (k - 0.5 * (n - 1.0)) / n) / channel.rate_hz) / n;
    }
    stamps_ns.push_back(std::llround(i * 1e9 / channel.rate_hz));
    values.push_back(value + channel.noise * noise(random));
  }
  const auto integrity =
      measure_integrity(Frequency::from_hz(channel.frequency_hz), stamps_ns, values, {});
  EXPECT_TRUE(integrity) << integrity.error().message;
  return integrity ? integrity->shape : SineShape{};
}

BentPeaks peaks_of(const Channel& sensor, Channel reference, unsigned seed) {
  std::mt19937_64 random(seed);
  const double phase = std::uniform_real_distribution<double>(-3.0, 3.0)(random);
  reference.frequency_hz = sensor.frequency_hz;
  reference.harmonics = sensor.harmonics;
  reference.delay_rad = 0.0;
  reference.rate_hz = 5000.0;
  return find_bent_peaks(shape_of(sensor, phase, random), shape_of(reference, phase, random));
}

// What the fundamental of a sine with cut peaks loses, by Fourier's integral.
double lost(double limit) {
  const double d = std::acos(limit);
  return (d - std::sin(d) * std::cos(d)) / std::numbers::pi;
}

TEST(PeakShape, CutPeaksAreFoundWithWhatTheyTakeAway) {
  for (const double limit : {0.99, 0.97, 0.9}) {
    for (const double frequency_hz : {12.5, 31.5, 80.3, 160.2}) {
      for (unsigned seed = 1; seed <= 3; ++seed) {
        Channel sensor{.frequency_hz = frequency_hz};
        sensor.upper = sensor.lower = limit;
        const BentPeaks both = peaks_of(sensor, {}, seed);
        EXPECT_TRUE(both.found) << limit << " of " << frequency_hz << " Hz";
        EXPECT_NEAR(both.amplitude_error_rel, 2.0 * lost(limit), 0.3 * 2.0 * lost(limit));
        sensor.upper = none;
        const BentPeaks one = peaks_of(sensor, {}, seed);
        EXPECT_TRUE(one.found) << "lower at " << limit << " of " << frequency_hz << " Hz";
        EXPECT_NEAR(one.amplitude_error_rel, lost(limit), 0.3 * lost(limit) + 1e-4);
        EXPECT_GT(one.lower_rel, 3.0 * std::abs(one.upper_rel));
      }
    }
  }
}

TEST(PeakShape, FilterBehindTheEndsHidesNothing) {
  for (const double frequency_hz : {12.5, 31.5, 63.2, 125.2}) {
    Channel sensor{.frequency_hz = frequency_hz, .noise = 0.002, .mean_of = 16};
    sensor.upper = sensor.lower = 0.97;
    const BentPeaks peaks = peaks_of(sensor, {}, 1);
    EXPECT_TRUE(peaks.found) << frequency_hz << " Hz";
    EXPECT_GT(peaks.amplitude_error_rel, lost(0.97));
  }
}

TEST(PeakShape, ReferenceWithCutPeaksIsTold) {
  Channel reference;
  reference.upper = reference.lower = 0.95;
  const BentPeaks peaks = peaks_of({.frequency_hz = 16.0}, reference, 1);
  EXPECT_TRUE(peaks.found);
  EXPECT_LT(peaks.amplitude_error_rel, -0.5 * lost(0.95));
}

// At an eighth of the sensor's rate it shows the second alone of the reference's harmonics.
TEST(PeakShape, ReferenceIsTooWhereTheSensorShowsFewOrders) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Channel reference;
    reference.upper = 0.9;
    const BentPeaks peaks = peaks_of({.frequency_hz = 125.2, .seconds = 2.0}, reference, seed);
    EXPECT_TRUE(peaks.found);
    EXPECT_NEAR(peaks.amplitude_error_rel, -lost(0.9), 0.3 * lost(0.9));
  }
}

// The sensor shows none of its harmonics but the second, which ends on both sides leave alone.
TEST(PeakShape, AFlatTopOfTheReferenceIsUnmistakable) {
  for (const double limit : {0.9, 0.95, 0.97}) {
    for (const double frequency_hz : {90.0, 100.3, 128.0, 160.0, 203.0, 240.0}) {
      for (unsigned seed = 1; seed <= 3; ++seed) {
        Channel reference;
        reference.upper = reference.lower = limit;
        const BentPeaks peaks = peaks_of({.frequency_hz = frequency_hz}, reference, seed);
        EXPECT_TRUE(peaks.found) << limit << " of " << frequency_hz << " Hz";
        EXPECT_NEAR(peaks.amplitude_error_rel, -2.0 * lost(limit), 0.4 * 2.0 * lost(limit));
      }
    }
  }
}

// Four and more harmonics of any phase that the sensor's filter takes away.
TEST(PeakShape, HarmonicsOfTheExciterAreNoFlatTop) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  int found = 0;
  constexpr int runs = 20000;
  for (int run = 0; run < runs; ++run) {
    SineShape reference{
        .order_of_half_rate = 15.0, .steps_rel = 0.0, .periods = 200.0, .harmonics = {}};
    SineShape sensor{
        .order_of_half_rate = 3.0, .steps_rel = 0.0, .periods = 200.0, .harmonics = {}};
    for (int k = 2; k <= 9; ++k) {
      const double size = 0.05 * part(random) / (k - 1);
      const auto value = std::polar(k % 2 == 0 ? 0.2 * size : size, 6.2832 * part(random));
      reference.harmonics.push_back({k, value, 2e-5});
      sensor.harmonics.push_back({k, {}, 2e-4});
    }
    found += find_bent_peaks(sensor, reference).found ? 1 : 0;
  }
  EXPECT_LE(found, runs / 5000);
}

// An amplifier that clips moves both, and a filter of the sensor takes half of its second harmonic.
TEST(PeakShape, PeaksThatTheExciterBendsAreNotTheReferences) {
  int found = 0;
  for (unsigned run = 0; run < 100; ++run) {
    std::mt19937_64 random(run);
    const double phase = std::uniform_real_distribution<double>(-3.0, 3.0)(random);
    Channel reference{.frequency_hz = 125.2, .rate_hz = 5000.0, .delay_rad = 0.0};
    reference.upper = 0.9;
    Channel sensor = reference;
    sensor.rate_hz = 1003.05;
    sensor.delay_rad = 0.4;
    SineShape shown = shape_of(sensor, phase, random);
    for (ShapeHarmonic& one : shown.harmonics) {
      one.relative *= 0.5;
    }
    found += find_bent_peaks(shown, shape_of(reference, phase, random)).found ? 1 : 0;
  }
  EXPECT_EQ(found, 0);
}

// Harmonics of the exciter, squares and cubes of a good sensor, any noise: nothing is bent.
TEST(PeakShape, SoundChannelsRaiseNoAlarm) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  int found = 0;
  std::ostringstream which;
  constexpr int runs = 500;
  for (int run = 0; run < runs; ++run) {
    Channel sensor{.frequency_hz = 5.0 * std::pow(80.0, part(random)),
                   .noise = 1e-4 * std::pow(3e3, part(random)),
                   .seconds = 1.0};
    sensor.harmonics = {0.03 * part(random), 0.03 * part(random), 0.003 * part(random)};
    sensor.own = {0.002 * part(random), 0.0015 * part(random)};
    const BentPeaks peaks = peaks_of(sensor, {.seconds = 1.0}, static_cast<unsigned>(run));
    if (peaks.found) {
      ++found;
      which << " " << sensor.frequency_hz << " Hz, noise " << sensor.noise << ", error "
            << peaks.amplitude_error_rel << " u " << peaks.u << "\n";
    }
  }
  EXPECT_LE(found, runs / 500) << which.str();
}

// Harmonics fold beside the signal, where an exciter that wanders has its sidebands.
TEST(PeakShape, AnExciterThatWandersBendsNothing) {
  int found = 0;
  for (const double frequency_hz : {125.0, 160.0, 200.0, 250.0}) {
    for (unsigned run = 0; run < 50; ++run) {
      const double by_hz = 1.0 + 0.1 * run;
      Channel sensor{.frequency_hz = frequency_hz, .modulated = 0.02, .by_hz = by_hz};
      sensor.seconds = 3.0;
      found += peaks_of(sensor, {.seconds = 3.0, .modulated = 0.02, .by_hz = by_hz}, run).found;
    }
  }
  EXPECT_EQ(found, 0);
}

// A filter behind the ends that turns harmonics makes them those of a cut reference, but for where
// they are.
TEST(PeakShape, TurnedHarmonicsDoNotTellWhichIsBent) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937_64 random(seed);
    Channel cut{.frequency_hz = 31.5};
    cut.upper = cut.lower = 0.9;
    const Channel sound{.frequency_hz = 31.5, .rate_hz = 5000.0, .delay_rad = 0.0};
    SineShape sensor = shape_of(cut, 0.3, random);
    const SineShape reference = shape_of(sound, 0.3, random);
    EXPECT_FALSE(find_bent_peaks(sensor, reference).of_either);
    for (ShapeHarmonic& one : sensor.harmonics) {
      one.relative = -one.relative;
    }
    const BentPeaks turned = find_bent_peaks(sensor, reference);
    EXPECT_TRUE(turned.found);
    EXPECT_TRUE(turned.of_either);
    const BentPeaks of_reference = find_bent_peaks(reference, shape_of(cut, 0.3, random));
    EXPECT_TRUE(of_reference.found);
    EXPECT_LT(of_reference.amplitude_error_rel, 0.0);
    EXPECT_FALSE(of_reference.of_either);
  }
}

// The step of a quarter in H between f and 2 f, 3 f of a sensor is not a bent peak.
TEST(PeakShape, ResponseThatFallsIsAllowedFor) {
  int found = 0;
  for (unsigned run = 0; run < 100; ++run) {
    std::mt19937_64 random(run);
    const double phase = std::uniform_real_distribution<double>(-3.0, 3.0)(random);
    const Channel reference{.rate_hz = 5000.0, .delay_rad = 0.0, .harmonics = {0.02, 0.02}};
    Channel sensor = reference;
    sensor.rate_hz = 1003.05;
    sensor.delay_rad = 0.4;
    sensor.harmonics = {0.015, 0.014};
    found +=
        find_bent_peaks(shape_of(sensor, phase, random), shape_of(reference, phase, random)).found
            ? 1
            : 0;
  }
  EXPECT_EQ(found, 0);
}

Channel derived(Channel reference, int derivative) {
  reference.rate_hz = 1003.05;
  reference.delay_rad = 0.4;
  reference.derivative = derivative;
  return reference;
}

// As a velocity coil beside a displacement of an exciter at the end of its stroke: its harmonics
// are larger and turned, and it is not bent.
TEST(PeakShape, SensorOfAnotherQuantityIsNotBent) {
  int needless = 0, of_one_kind = 0;
  for (const int derivative : {-2, -1, 1, 2}) {
    for (unsigned run = 0; run < 60; ++run) {
      std::mt19937_64 random(run + 300);
      std::uniform_real_distribution<double> part(0.3, 1.0);
      const double phase = 6.0 * part(random), size = part(random);
      const Channel reference{.frequency_hz = 10.0 + 40.0 * part(random),
                              .rate_hz = 5000.0,
                              .delay_rad = 0.0,
                              .harmonics = {0.02 * size, 0.012 * size, 0.007 * size, 0.003 * size},
                              .per_order_rad = 0.5 * std::numbers::pi,
                              .first_rad = -0.5 * std::numbers::pi};
      const SineShape sensor = shape_of(derived(reference, derivative), phase, random);
      const SineShape seen = shape_of(reference, phase, random);
      needless += find_bent_peaks(sensor, seen, other_quantity).found ? 1 : 0;
      of_one_kind += find_bent_peaks(sensor, seen).found ? 1 : 0;
    }
  }
  EXPECT_LE(needless, 1);
  EXPECT_GE(of_one_kind, 60); // what this case is about
}

// Where the exciter has few harmonics of its own.
TEST(PeakShape, CutPeaksAreFoundInWhateverTheSensorReads) {
  constexpr int runs = 60;
  for (const int derivative : {-2, -1, 0, 1, 2}) {
    int of_sensor = 0, of_reference = 0;
    for (unsigned run = 0; run < runs; ++run) {
      std::mt19937_64 random(run + 300);
      std::uniform_real_distribution<double> part(0.0, 1.0);
      const double phase = 6.0 * part(random);
      Channel reference{.frequency_hz = 10.0 + 70.0 * part(random),
                        .rate_hz = 5000.0,
                        .delay_rad = 0.0,
                        .harmonics = {0.003 * part(random), 0.001 * part(random)}};
      Channel sensor = derived(reference, derivative);
      const SineShape whole = shape_of(sensor, phase, random);
      const SineShape seen = shape_of(reference, phase, random);
      sensor.upper = sensor.lower = reference.upper = reference.lower = 0.9;
      const auto bent = find_bent_peaks(shape_of(sensor, phase, random), seen, other_quantity);
      of_sensor += bent.found ? 1 : 0;
      const auto other = find_bent_peaks(whole, shape_of(reference, phase, random), other_quantity);
      of_reference += other.found ? 1 : 0;
    }
    EXPECT_GE(of_sensor, runs * 3 / 4) << derivative;
    // An acceleration has nine times the third harmonic of its displacement.
    EXPECT_GE(of_reference, derivative == 2 ? 1 : runs * 3 / 4) << derivative;
  }
}

} // namespace
} // namespace dyncal::analysis
