#include "analysis/step/excitation_window.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace dyncal::analysis {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

struct Part { // of a sync signal: a sine, or silence when the amplitude is 0
  double frequency_hz;
  double amplitude;
  double duration_s;
  double phase_rad = 0.0;
  double rise_s = 0.0; // first-order approach to the amplitude
};

struct Recorder {
  double rate_hz = 20000.0;
  double offset = 0.0;
  double step = 0.0; // of the converter, 0: none
  double noise = 1e-3;
  std::int64_t epoch_ns = 1'700'000'000'123'456'789;
  unsigned seed = 1;
};

struct Stream {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  std::vector<std::int64_t> begins_ns; // of the parts, and the end
};

Stream record(const std::vector<Part>& parts, const Recorder& recorder) {
  std::mt19937 random(recorder.seed);
  std::normal_distribution<double> noise(0.0, recorder.noise);
  Stream stream;
  double begin_s = 0.0;
  std::size_t i = 0;
  for (const Part& part : parts) {
    stream.begins_ns.push_back(recorder.epoch_ns + std::llround(begin_s * 1e9));
    for (;; ++i) {
      const double t = static_cast<double>(i) / recorder.rate_hz - begin_s;
      if (t >= part.duration_s) {
        break;
      }
      const double rise = part.rise_s > 0.0 ? 1.0 - std::exp(-t / part.rise_s) : 1.0;
      double y = recorder.offset + noise(random) +
                 rise * part.amplitude *
                     std::sin(2.0 * std::numbers::pi * part.frequency_hz * t + part.phase_rad);
      if (recorder.step > 0.0) {
        y = recorder.step * std::round(y / recorder.step);
      }
      stream.stamps_ns.push_back(recorder.epoch_ns +
                                 std::llround(static_cast<double>(i) / recorder.rate_hz * 1e9));
      stream.values.push_back(y);
    }
    begin_s += part.duration_s;
  }
  stream.begins_ns.push_back(recorder.epoch_ns + std::llround(begin_s * 1e9));
  return stream;
}

Frequency hz(double value) {
  return Frequency::from_hz(value);
}

std::optional<ExcitationWindow> search(const Stream& stream, double frequency_hz,
                                       std::size_t first = 0) {
  ExcitationWindowFinder finder(hz(frequency_hz));
  finder.push(std::span(stream.stamps_ns).subspan(first), std::span(stream.values).subspan(first));
  finder.finish();
  return finder.window();
}

// Inside part `k`, and no more than two frames shorter at either end.
void expect_within_part(const ExcitationWindow& window, const Stream& stream, std::size_t k,
                        double frequency_hz) {
  const std::int64_t frame_ns = ExcitationWindowFinder(hz(frequency_hz)).frame_ns();
  EXPECT_GE(window.begin_ns, stream.begins_ns[k]) << k;
  EXPECT_LE(window.end_ns, stream.begins_ns[k + 1]) << k;
  EXPECT_LE(window.begin_ns, stream.begins_ns[k] + 2 * frame_ns) << k;
  EXPECT_GE(window.end_ns, stream.begins_ns[k + 1] - 2 * frame_ns) << k;
  EXPECT_TRUE(window.ended);
}

TEST(ExcitationWindow, FindsEveryStepOfARunWithNeighbouringFrequencies) {
  const std::vector<double> plan{46.7, 50.0, 53.3, 46.7, 50.0, 53.3, 50.0, 50.0};
  std::vector<Part> parts;
  for (double f : plan) {
    parts.push_back({0.0, 0.0, 0.3});
    parts.push_back({f, 1.0, 2.0, 0.3 * f});
  }
  parts.push_back({0.0, 0.0, 0.3});
  const Stream stream = record(parts, {});
  std::size_t first = 0;
  for (std::size_t step = 0; step < plan.size(); ++step) {
    const auto window = search(stream, plan[step], first);
    ASSERT_TRUE(window.has_value()) << step;
    expect_within_part(*window, stream, 2 * step + 1, plan[step]);
    while (stream.stamps_ns[first] < window->off_ns) {
      ++first;
    }
  }
}

TEST(ExcitationWindow, IsTheSameHoweverTheStreamWasCut) {
  const Stream stream = record({{0, 0, 0.31}, {80.0, 1.0, 1.7, 0.4}, {0, 0, 0.5}}, {});
  const auto whole = search(stream, 80.0);
  ASSERT_TRUE(whole.has_value());
  for (const std::size_t piece : {1u, 7u, 999u, 4001u}) {
    ExcitationWindowFinder finder(hz(80.0));
    for (std::size_t i = 0; i < stream.values.size(); i += piece) {
      const std::size_t n = std::min(piece, stream.values.size() - i);
      finder.push(std::span(stream.stamps_ns).subspan(i, n),
                  std::span(stream.values).subspan(i, n));
    }
    finder.finish();
    const auto cut = finder.window();
    ASSERT_TRUE(cut.has_value());
    EXPECT_EQ(cut->begin_ns, whole->begin_ns);
    EXPECT_EQ(cut->end_ns, whole->end_ns);
    EXPECT_EQ(cut->amplitude, whole->amplitude);
    EXPECT_EQ(cut->frequency_offset_rel, whole->frequency_offset_rel);
  }
}

TEST(ExcitationWindow, GrowsWhileTheSineGoesOnAndEndsWithIt) {
  const Stream stream = record({{40.0, 1.0, 2.0}, {0, 0, 1.0}}, {});
  ExcitationWindowFinder finder(hz(40.0));
  std::int64_t end_ns = 0;
  for (std::size_t i = 0; i < 36000; i += 1000) {
    finder.push(std::span(stream.stamps_ns).subspan(i, 1000),
                std::span(stream.values).subspan(i, 1000));
    EXPECT_FALSE(finder.ended());
    if (const auto window = finder.window()) {
      EXPECT_GE(window->end_ns, end_ns);
      EXPECT_FALSE(window->ended);
      end_ns = window->end_ns;
    }
  }
  EXPECT_GT(end_ns, stream.begins_ns[0] + second_ns);
  finder.push(std::span(stream.stamps_ns).subspan(36000), std::span(stream.values).subspan(36000));
  EXPECT_TRUE(finder.ended());
  expect_within_part(*finder.window(), stream, 0, 40.0);
}

TEST(ExcitationWindow, BridgesLostSamples) {
  Stream stream = record({{0, 0, 0.5}, {63.0, 1.0, 3.0}, {0, 0, 0.5}}, {});
  stream.stamps_ns.erase(stream.stamps_ns.begin() + 30000, stream.stamps_ns.begin() + 37000);
  stream.values.erase(stream.values.begin() + 30000, stream.values.begin() + 37000);
  const auto window = search(stream, 63.0);
  ASSERT_TRUE(window.has_value());
  expect_within_part(*window, stream, 1, 63.0);
}

TEST(ExcitationWindow, HoldsFromOneHertzToTenKilohertz) {
  for (const double f : {1.0, 1.7, 3.15, 10.0, 31.5, 125.0, 999.0, 3150.0, 10000.0}) {
    const Stream stream = record({{0, 0, 0.7}, {f, 0.5, 6.0}, {0, 0, 1.5}}, {.rate_hz = 50000.0});
    const auto window = search(stream, f);
    ASSERT_TRUE(window.has_value()) << f;
    expect_within_part(*window, stream, 1, f);
    EXPECT_NEAR(window->amplitude, 0.5, 0.005) << f;
  }
}

TEST(ExcitationWindow, HoldsForSensorRatesUpToNearHalfOfThem) {
  for (const double f : {10.0, 80.0, 200.0, 250.0, 440.0, 490.0}) {
    const Stream stream =
        record({{0, 0, 0.4}, {f, 0.166, 3.0}, {0, 0, 0.4}},
               {.rate_hz = 1003.049, .offset = 1.5, .step = 4.88e-3, .noise = 4.88e-3});
    const auto window = search(stream, f);
    ASSERT_TRUE(window.has_value()) << f;
    expect_within_part(*window, stream, 1, f);
  }
}

TEST(ExcitationWindow, SeesASineOfAFewConverterSteps) {
  const Stream stream = record({{0, 0, 0.4}, {20.0, 0.02, 3.0}, {0, 0, 0.4}},
                               {.rate_hz = 1000.0, .offset = 1.5, .step = 4.88e-3, .noise = 2e-3});
  const auto window = search(stream, 20.0);
  ASSERT_TRUE(window.has_value());
  expect_within_part(*window, stream, 1, 20.0);
}

TEST(ExcitationWindow, FollowsAGeneratorThatIsOffByAThousandth) {
  for (const double f : {1.0, 50.0, 10000.0}) {
    for (const double offset : {-1e-3, 1e-3}) {
      const Stream stream =
          record({{0, 0, 0.5}, {f * (1.0 + offset), 1.0, 5.0}, {0, 0, 1.5}}, {.rate_hz = 50000.0});
      const auto window = search(stream, f);
      ASSERT_TRUE(window.has_value()) << f;
      expect_within_part(*window, stream, 1, f);
      EXPECT_NEAR(window->frequency_offset_rel, offset, 2e-5);
    }
  }
}

TEST(ExcitationWindow, TellsFrequencyAndPhaseOfTheSine) {
  for (const double offset_rel : {-8e-4, 0.0, 5e-5}) {
    const double real_hz = 80.0 * (1.0 + offset_rel);
    const Stream stream =
        record({{0.0, 0.0, 0.5}, {real_hz, 1.0, 2.0, 0.7}, {0.0, 0.0, 0.5}}, {.noise = 0.01});
    const auto window = search(stream, 80.0);
    ASSERT_TRUE(window.has_value());
    EXPECT_NEAR(window->frequency_hz / real_hz, 1.0, 4.0 * window->u_frequency_rel);
    EXPECT_LT(window->u_frequency_rel, 2e-6);
    EXPECT_GT(window->u_frequency_rel, 1e-8);
    EXPECT_GT(window->middle_ns, window->begin_ns);
    EXPECT_LT(window->middle_ns, window->end_ns);
    const double since_begin_s =
        static_cast<double>(window->middle_ns - stream.begins_ns[1]) * 1e-9;
    const double phase_rad = 2.0 * std::numbers::pi * real_hz * since_begin_s + 0.7;
    EXPECT_NEAR(std::remainder(window->phase_rad - phase_rad, 2.0 * std::numbers::pi), 0.0,
                4.0 * window->u_phase_rad);
    EXPECT_LT(window->u_phase_rad, 1e-3);
  }
}

TEST(ExcitationWindow, LeavesOutTheRiseOfTheAmplitude) {
  const Stream stream = record({{0, 0, 0.5}, {80.0, 1.0, 4.0, 0.0, 0.3}, {0, 0, 0.5}}, {});
  const auto window = search(stream, 80.0);
  ASSERT_TRUE(window.has_value());
  EXPECT_GE(window->begin_ns,
            stream.begins_ns[1] + 9 * second_ns / 10); // 5 % are left after three time constants
  EXPECT_LE(window->begin_ns, stream.begins_ns[1] + 13 * second_ns / 10);
  EXPECT_LE(window->excited_begin_ns, stream.begins_ns[1] + 2 * second_ns / 10);
  EXPECT_LE(window->end_ns, stream.begins_ns[2]);
}

TEST(ExcitationWindow, KeepsStepsOfTheSameFrequencyApart) {
  for (const double f : {1.0, 5.0, 10.0, 160.0}) {
    for (const double phase : {0.0, 0.7, 1.5, 2.2}) {
      // The generator only gates its output: the second step goes on as if the first had never
      // stopped.
      const double off_s = 0.2;
      const double on_s = 5.0;
      const double later = phase + 2.0 * std::numbers::pi * f * (on_s + off_s);
      const Stream stream =
          record({{f, 1.0, on_s, phase}, {0, 0, off_s}, {f, 1.0, on_s, later}, {0, 0, 1.2}},
                 {.rate_hz = 5000.0});
      const auto window = search(stream, f);
      ASSERT_TRUE(window.has_value()) << f;
      expect_within_part(*window, stream, 0, f);
    }
  }
}

TEST(ExcitationWindow, FindsNothingInNoiseOrInAnotherSine) {
  EXPECT_FALSE(search(record({{0, 0, 60.0}}, {.rate_hz = 1000.0, .noise = 1.0}), 80.0));
  EXPECT_FALSE(search(record({{0, 0, 60.0}}, {.rate_hz = 200.0, .noise = 1.0}), 10.0));
  EXPECT_FALSE(search(record({{53.3, 1.0, 10.0}}, {}), 50.0));
  EXPECT_FALSE(search(record({{12.5, 1.0, 10.0}}, {}), 10.0));
  EXPECT_FALSE(search(record({{1.25, 1.0, 10.0}}, {}), 1.0));
  EXPECT_FALSE(search(
      record({{0, 0, 10.0}}, {.rate_hz = 1000.0, .offset = 1.5, .step = 4.88e-3, .noise = 0.0}),
      80.0));
}

// Hum of half a percent is a clean sine where nothing is excited, and beside 50 Hz it looks like
// the step's; the step begins at any instant of a frame.
TEST(ExcitationWindow, IsNotTheHumBeforeTheExcitation) {
  for (const double f : {49.8, 49.9, 50.0, 50.1, 50.2}) {
    for (int k = 0; k < 40; ++k) {
      const Part hum{50.0, 5e-3, 0.5 + 2.5e-3 * k, 0.1 * k};
      const Stream stream =
          record({hum, {f, 1.0, 2.0, 1.3 * k, 0.005}, hum}, {.rate_hz = 1000.0, .noise = 3e-4});
      const auto window = search(stream, f);
      ASSERT_TRUE(window.has_value()) << f << " Hz, " << k;
      expect_within_part(*window, stream, 1, f);
    }
  }
}

// A frame that holds the end of one step and the beginning of the next may pass for a sine that is
// a little off, with any phases; the step must not fall in two there.
TEST(ExcitationWindow, FindsWholeStepsOfPeriodsLongerThanTheirPauses) {
  constexpr int phases = 12;
  for (int k = 0; k < 6 * phases * phases; ++k) {
    const std::int64_t epoch_ns = 1'700'000'000'123'456'789 + (k % 6) * 400'000'000LL;
    const auto phase = [](int part) { return 2.0 * std::numbers::pi * part / phases; };
    const Stream stream = record({{0.41, 1.0, 17.4, phase(k / 6 / phases)},
                                  {0, 0, 0.5},
                                  {0.42, 1.0, 17.4, phase(k / 6 % phases)},
                                  {0, 0, 0.5},
                                  {0.43, 1.0, 17.2, 1.0},
                                  {0, 0, 0.5}},
                                 {.rate_hz = 40.0, .epoch_ns = epoch_ns});
    std::size_t first = 0;
    for (std::size_t step = 0; step < 3; ++step) {
      const double frequency_hz = 0.41 + 0.01 * static_cast<double>(step);
      const auto window = search(stream, frequency_hz, first);
      ASSERT_TRUE(window) << k << ", step " << step;
      expect_within_part(*window, stream, 2 * step, frequency_hz);
      while (first < stream.stamps_ns.size() && stream.stamps_ns[first] < window->off_ns) {
        ++first;
      }
    }
  }
}

TEST(ExcitationWindow, DoesNotTakeTwoFramesOfANeighbouringSine) {
  for (const double f : {0.40, 0.405, 0.41, 0.42, 0.44, 0.45, 0.46}) {
    for (const double duration_s : {5.0, 7.5, 10.0, 20.0}) {
      const Stream stream =
          record({{0, 0, 0.5}, {f, 1.0, duration_s}, {0, 0, 4.0}}, {.rate_hz = 100.0});
      EXPECT_FALSE(search(stream, 0.43)) << f << " Hz, " << duration_s << " s";
    }
  }
}

TEST(ExcitationWindow, LeavesOutSamplesThatCannotBe) {
  Stream stream = record({{0, 0, 0.3}, {63.0, 1.0, 2.0}, {0, 0, 0.3}}, {});
  stream.values[20000] = std::nan("");
  stream.stamps_ns[21000] = stream.stamps_ns[20999];
  ExcitationWindowFinder finder(hz(63.0));
  finder.push(stream.stamps_ns, stream.values);
  finder.finish();
  ASSERT_TRUE(finder.window().has_value());
  EXPECT_EQ(finder.ignored_samples(), 2u);
  expect_within_part(*finder.window(), stream, 1, 63.0);
}

// Three lines at once, which a search for one of them would take for noise.
Stream record_multisine(const std::vector<double>& lines_hz, double quiet_s, double on_s) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1e-3);
  Stream stream;
  for (int i = 0; i < std::lround(1000.0 * (2.0 * quiet_s + on_s)); ++i) {
    const double t = 1e-3 * i;
    double y = noise(random);
    for (std::size_t k = 0; k < lines_hz.size() && t >= quiet_s && t < quiet_s + on_s; ++k) {
      y += std::sin(2.0 * std::numbers::pi * lines_hz[k] * t + static_cast<double>(k * k));
    }
    stream.stamps_ns.push_back(second_ns * 1000 + 1'000'000L * i);
    stream.values.push_back(y);
  }
  return stream;
}

TEST(ExcitationWindow, FindsAMultisineInOneOfItsLines) {
  const Stream stream = record_multisine({10.1, 12.3, 16.1}, 3.0, 15.0);
  ExcitationWindowFinder alone(hz(10.1));
  alone.push(stream.stamps_ns, stream.values);
  alone.finish();
  EXPECT_FALSE(alone.window().has_value());

  ExcitationWindowFinder finder(hz(10.1), {}, {hz(12.3), hz(16.1)});
  finder.push(stream.stamps_ns, stream.values);
  EXPECT_TRUE(finder.ended()) << "its end shows in what follows";
  const auto window = finder.window();
  ASSERT_TRUE(window.has_value());
  EXPECT_NEAR(window->amplitude, 1.0, 0.01);
  EXPECT_NEAR(window->frequency_hz, 10.1, 1e-4);
  const double begin_s = 1e-9 * static_cast<double>(window->begin_ns - stream.stamps_ns.front());
  const double end_s = 1e-9 * static_cast<double>(window->end_ns - stream.stamps_ns.front());
  EXPECT_GE(begin_s, 3.0);
  EXPECT_LE(begin_s, 3.0 + 2e-9 * static_cast<double>(finder.frame_ns()));
  EXPECT_LE(end_s, 18.0);
  EXPECT_GE(end_s, 18.0 - 2e-9 * static_cast<double>(finder.frame_ns()));
}

} // namespace
} // namespace dyncal::analysis
