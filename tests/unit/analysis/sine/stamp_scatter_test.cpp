#include "analysis/sine/stamp_scatter.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/sine/sine_residuals.hpp"

namespace dyncal::analysis {
namespace {

constexpr double rate_hz = 1003.05;

struct Recording {
  double frequency_hz = 80.3;
  double noise = 0.01; // of the amplitude
  std::size_t samples = 2000;
  std::function<double(double, std::mt19937_64&)> stamp_error_s = [](double, std::mt19937_64&) {
    return 0.0;
  };
  std::function<double(std::size_t, double)> value = [](std::size_t, double y) { return y; };
};

struct Measured {
  StampScatter scatter;
  double error_rel = 0.0; // of the fitted amplitude
};

Measured measure(const Recording& recording, unsigned seed,
                 SlowScatter slow = SlowScatter::corrected_in_blocks) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, recording.noise);
  const double w = 2.0 * std::numbers::pi * recording.frequency_hz;
  const double phase = std::uniform_real_distribution<double>(-3.0, 3.0)(random);
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  for (std::size_t i = 0; i < recording.samples; ++i) {
    const double t = static_cast<double>(i) / rate_hz;
    const double seen_s = t + recording.stamp_error_s(t, random);
    values.push_back(recording.value(i, std::sin(w * t + phase) + noise(random)));
    stamps_ns.push_back(std::llround(seen_s * 1e9));
    if (i > 0) {
      stamps_ns[i] = std::max(stamps_ns[i], stamps_ns[i - 1] + 1);
    }
  }
  const Frequency frequency = Frequency::from_hz(recording.frequency_hz);
  const std::int64_t middle_ns = middle_of_record_ns(stamps_ns);
  const std::span<const double> channel[] = {values};
  const auto fit = fit_sine(frequency, middle_ns, stamps_ns, channel);
  if (!fit) { // noise far above the sine
    return {};
  }
  return {measure_stamp_scatter(frequency, fit->front(), middle_ns, stamps_ns, values, 0.0, slow),
          1.0 - fit->front().amplitude()};
}

double rounded(double t, double tick_s) {
  return tick_s * std::round(t / tick_s) - t;
}

// A tick T shortens by sinc(f T), and the residuals show it.
TEST(StampScatter, TicksAreFound) {
  for (const double tick_s : {2e-4, 5e-4, 1e-3}) {
    Recording recording;
    recording.stamp_error_s = [&](double t, auto&) { return rounded(t, tick_s); };
    const double x = std::numbers::pi * recording.frequency_hz * tick_s;
    const double expected = 1.0 - std::sin(x) / x;
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const auto [scatter, error] = measure(recording, seed, SlowScatter::counts);
      EXPECT_NEAR(scatter.correction_rel(), expected, 3.0 * scatter.u_correction_rel())
          << tick_s << " s, seed " << seed << ", error " << error;
      EXPECT_LT(scatter.u_correction_rel(), 0.2 * expected + 1e-4);
    }
  }
}

// exp(-(w s)^2 / 2) for normal scatter, 1 / sqrt(1 + (w s)^2) for one-sided latencies.
TEST(StampScatter, ScatterIsFoundWhateverItsDistribution) {
  constexpr double s = 1e-4;
  Recording normal{.frequency_hz = 200.0};
  normal.stamp_error_s = [](double, auto& random) {
    return std::normal_distribution<double>(0.0, s)(random);
  };
  Recording one_sided{.frequency_hz = 200.0};
  one_sided.stamp_error_s = [](double, auto& random) {
    return std::exponential_distribution<double>(1.0 / s)(random);
  };
  const double turn = 2.0 * std::numbers::pi * 200.0 * s;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const auto of_normal = measure(normal, seed).scatter;
    EXPECT_NEAR(of_normal.correction_rel(), 1.0 - std::exp(-0.5 * turn * turn),
                3.0 * of_normal.u_correction_rel());
    const auto of_one_sided = measure(one_sided, seed).scatter;
    EXPECT_NEAR(of_one_sided.correction_rel(), 1.0 - 1.0 / std::sqrt(1.0 + turn * turn),
                3.0 * of_one_sided.u_correction_rel());
  }
}

// Jitter of the instants is none of the stamps that show it; noise of any size is none either.
TEST(StampScatter, NothingIsCorrectedInSoundRecords) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  for (unsigned run = 0; run < 1000; ++run) {
    Recording recording;
    recording.frequency_hz = 2.0 * std::pow(200.0, part(random));
    recording.noise = 1e-5 * std::pow(1e5, part(random));
    recording.samples = static_cast<std::size_t>(200.0 * std::pow(20.0, part(random)));
    recording.stamp_error_s = [](double, auto& draw) {
      return std::normal_distribution<double>(0.0, 1e-8)(draw);
    };
    EXPECT_EQ(measure(recording, run).scatter.correction_rel(), 0.0) << "run " << run;
  }
}

// Of any phases, folded or not; and beside it, scatter is found as without it.
TEST(StampScatter, DistortionIsNotScatter) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  for (unsigned run = 0; run < 200; ++run) {
    const double turned = 6.0 * part(random), size = 0.01 + 0.02 * part(random);
    Recording recording{.frequency_hz = 90.0 + 170.0 * part(random), .noise = 0.002};
    recording.samples = 1500;
    const double w = 2.0 * std::numbers::pi * recording.frequency_hz;
    recording.value = [=](std::size_t i, double y) {
      const double phase = w * static_cast<double>(i) / rate_hz;
      return y + size * std::sin(2.0 * phase + turned) + 0.7 * size * std::sin(3.0 * phase) +
             0.5 * size * std::sin(4.0 * phase - turned);
    };
    EXPECT_EQ(measure(recording, run).scatter.correction_rel(), 0.0)
        << "run " << run << ", " << recording.frequency_hz << " Hz";
    recording.stamp_error_s = [](double, auto& draw) {
      return std::normal_distribution<double>(0.0, 1e-4)(draw);
    };
    const StampScatter scatter = measure(recording, run).scatter;
    const double expected = 1.0 - std::exp(-0.5 * w * w * 1e-8);
    EXPECT_GT(scatter.correction_rel(), 0.5 * expected)
        << "run " << run << ", " << recording.frequency_hz << " Hz";
    EXPECT_NEAR(scatter.correction_rel(), expected, 4.0 * scatter.u_correction_rel() + 3e-4);
  }
}

TEST(StampScatter, FilterThatSwitchesIsNotScatter) {
  Recording recording{.frequency_hz = 80.0, .samples = 4000};
  recording.stamp_error_s = [](double t, auto&) { return t > 2.0 ? 1e-4 : 0.0; };
  EXPECT_LT(measure(recording, 1).scatter.correction_rel(), 2e-4); // 3e-4 in all
}

TEST(StampScatter, ReadBuffersShowInTheIntervals) {
  Recording recording;
  std::size_t number = 0;
  recording.stamp_error_s = [&](double, auto&) {
    const std::size_t in_batch = number++ % 8;
    return (7.0 - static_cast<double>(in_batch)) / rate_hz + 1e-8 * static_cast<double>(in_batch);
  };
  EXPECT_NEAR(measure(recording, 1).scatter.batched_part, 7.0 / 8.0, 0.01);
  EXPECT_EQ(measure(Recording{}, 1).scatter.batched_part, 0.0);
}

TEST(StampScatter, SamplesThatWrapAreCounted) {
  Recording recording;
  std::size_t wrapped = 0;
  recording.value = [&](std::size_t i, double y) {
    const bool wraps = i % 11 == 0 && y > 0.998;
    wrapped += wraps ? 1 : 0;
    return wraps ? y - 2.0 : y;
  };
  const StampScatter scatter = measure(recording, 1).scatter;
  ASSERT_GT(wrapped, 0U);
  EXPECT_EQ(scatter.peak_jumps, wrapped);
  EXPECT_EQ(measure(Recording{.noise = 0.9}, 1).scatter.peak_jumps, 0U);
}

TEST(StampScatter, ValuesOfOtherInstantsAreFarOff) {
  for (const double frequency_hz : {31.5, 80.3, 125.4}) {
    Recording recording{.frequency_hz = frequency_hz};
    std::mt19937_64 random(2);
    const double late = std::sin(2.0 * std::numbers::pi * frequency_hz / rate_hz);
    std::size_t moved = 0;
    recording.value = [&](std::size_t, double y) {
      const bool moves = std::uniform_real_distribution<double>(0.0, 1.0)(random) < 0.02;
      moved += moves ? 1 : 0;
      return moves ? y + late * std::sqrt(std::max(0.0, 1.0 - y * y)) : y;
    };
    const StampScatter scatter = measure(recording, 1).scatter;
    EXPECT_GE(scatter.far_off, moved / 4) << frequency_hz;
  }
  EXPECT_EQ(measure(Recording{}, 1).scatter.far_off, 0U);
  EXPECT_EQ(measure(Recording{.noise = 0.5}, 1).scatter.far_off, 0U);
}

} // namespace
} // namespace dyncal::analysis
