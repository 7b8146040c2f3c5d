#include "analysis/sine/kernel/sine_grid.hpp"

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/sine/kernel/sine_kernel.hpp"
#include "analysis/sine/sine_pass.hpp"
#include "tests/unit/analysis/sine/sine_signal.hpp"

namespace dyncal::analysis::kernel {
namespace {

constexpr std::int64_t interval_ns = 996'960;

std::vector<std::int64_t> jittering_stamps(std::size_t n, std::int64_t jitter_ns,
                                           unsigned seed = 3) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int64_t> shift(-jitter_ns, jitter_ns);
  std::vector<std::int64_t> stamps;
  for (std::size_t i = 0; i < n; ++i) {
    stamps.push_back(epoch_ns + static_cast<std::int64_t>(i) * interval_ns + shift(random));
  }
  return stamps;
}

std::vector<double> any_values(std::size_t n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> value(0.3, 2.0);
  std::vector<double> values(n);
  for (double& y : values) {
    y = value(random);
  }
  return values;
}

struct Input {
  std::vector<std::int64_t> stamps;
  std::vector<std::vector<double>> values;
  std::vector<const double*> pointers;
  Frequency frequency = *Frequency::parse("80.02");
  TimeAxis axis{};

  Input(std::vector<std::int64_t> at, std::size_t channels) : stamps(std::move(at)) {
    for (std::size_t j = 0; j < channels; ++j) {
      values.push_back(any_values(stamps.size(), static_cast<unsigned>(j)));
    }
    for (const auto& one : values) {
      pointers.push_back(one.data());
    }
    axis = {frequency.turns_per_ns_high(), frequency.turns_per_ns_low(),
            stamps[stamps.size() / 3] - 1'000'000'000'000'000, 1e-9};
  }
};

TEST(SampleGrid, GivesTheSameBitsOnEveryInstructionSet) {
  for (const std::int64_t jitter_ns : {60, 3'000}) { // third and fifth order
    for (const bool with_start : {false, true}) {
      const Input input(jittering_stamps(grid_call_samples, jitter_ns), grid_call_channels);
      const auto grid = sample_grid(input.stamps, input.frequency);
      ASSERT_TRUE(grid);
      for (std::size_t n = lanes; n <= grid_call_samples; n += n < 300 ? lanes : 41 * lanes) {
        for (std::size_t channels = 1; channels <= grid_call_channels; ++channels) {
          std::vector<Parameters> start(channels, with_start ? Parameters{0.3, -1.2, 0.1}
                                                             : Parameters{0.0, 0.0, 0.1});
          DesignSums first{};
          std::vector<ResidualSums> first_residuals(channels);
          EXPECT_EQ(baseline_kernel.fit_on_grid(input.stamps.data(), n, input.axis, *grid,
                                                input.pointers.data(), channels, start.data(),
                                                first, first_residuals.data()),
                    n);
          for (const SineKernel* const* kernel = supported_kernels(); *kernel; ++kernel) {
            DesignSums sums{};
            std::vector<ResidualSums> residuals(channels);
            EXPECT_EQ((*kernel)->fit_on_grid(input.stamps.data(), n, input.axis, *grid,
                                             input.pointers.data(), channels, start.data(), sums,
                                             residuals.data()),
                      n);
            EXPECT_EQ(std::memcmp(&sums, &first, sizeof sums), 0) << (*kernel)->name << ' ' << n;
            EXPECT_EQ(std::memcmp(residuals.data(), first_residuals.data(),
                                  channels * sizeof(ResidualSums)),
                      0)
                << (*kernel)->name << ' ' << n;
          }
        }
      }
    }
  }
}

// Both in units of what rounding leaves of sums of this many terms of order one.
TEST(SampleGrid, AgreesWithTheGeneralForm) {
  for (const std::int64_t jitter_ns :
       {0, 60, 600, 3'000, 7'000}) { // twice 7 us, of the sample and of the anchor, are 7 mrad
    for (const Parameters& p : {Parameters{0.0, 0.0, 0.3}, Parameters{1.5, -0.4, 0.3}}) {
      const Input input(jittering_stamps(grid_call_samples, jitter_ns), 1);
      const auto grid = sample_grid(input.stamps, input.frequency);
      ASSERT_TRUE(grid);
      DesignSums sums{}, expected{};
      ResidualSums residuals{}, expected_residuals{};
      ASSERT_EQ(best_kernel().fit_on_grid(input.stamps.data(), grid_call_samples, input.axis, *grid,
                                          input.pointers.data(), 1, &p, sums, &residuals),
                grid_call_samples);
      for (std::size_t i = 0; i < grid_call_samples; i += block_samples) {
        const double* values = input.pointers[0] + i;
        DesignSums block{};
        ResidualSums block_residuals{};
        best_kernel().fit_block(input.stamps.data() + i, block_samples, input.axis, &values, 1, &p,
                                block, &block_residuals);
        expected.s += block.s;
        expected.c += block.c;
        expected.ss += block.ss;
        expected.sc += block.sc;
        expected_residuals.e += block_residuals.e;
        expected_residuals.es += block_residuals.es;
        expected_residuals.ec += block_residuals.ec;
        expected_residuals.ee += block_residuals.ee;
      }
      const double tolerance = 3e-16 * static_cast<double>(grid_call_samples);
      EXPECT_NEAR(sums.s, expected.s, tolerance) << jitter_ns;
      EXPECT_NEAR(sums.c, expected.c, tolerance) << jitter_ns;
      EXPECT_NEAR(sums.ss, expected.ss, tolerance) << jitter_ns;
      EXPECT_NEAR(sums.sc, expected.sc, tolerance) << jitter_ns;
      EXPECT_NEAR(residuals.e, expected_residuals.e, 5.0 * tolerance) << jitter_ns;
      EXPECT_NEAR(residuals.es, expected_residuals.es, 5.0 * tolerance) << jitter_ns;
      EXPECT_NEAR(residuals.ec, expected_residuals.ec, 5.0 * tolerance) << jitter_ns;
      EXPECT_NEAR(residuals.ee, expected_residuals.ee, 20.0 * tolerance) << jitter_ns;
    }
  }
}

struct SeriesOfCall {
  DesignSums design{};
  SlopeSums slope{};
  ResidualSums residuals[2]{};
  ResidualSlopeSums residual_slopes[2]{};
};

TEST(SampleGrid, GivesTheSameSeriesOnEveryInstructionSetAndByTheGeneralForm) {
  for (const std::int64_t jitter_ns : {60, 3'000}) {
    Input input(jittering_stamps(grid_call_samples, jitter_ns), 2);
    input.axis.inverse_scale = 1e-9;
    input.axis.origin_ns = input.stamps[700];
    const Parameters start[] = {{0.3, -1.2, 0.1}, {}};
    const auto grid = sample_grid(input.stamps, input.frequency);
    ASSERT_TRUE(grid);
    for (const std::size_t n :
         {std::size_t{8}, std::size_t{200}, std::size_t{264}, block_samples}) {
      const auto series_by = [&](const SineKernel& kernel) {
        SeriesOfCall series;
        EXPECT_EQ(kernel.series_on_grid(input.stamps.data(), n, input.axis, *grid,
                                        input.pointers.data(), 2, start, series.design,
                                        series.slope, series.residuals, series.residual_slopes),
                  n);
        return series;
      };
      const SeriesOfCall first = series_by(baseline_kernel);
      for (const SineKernel* const* kernel = supported_kernels(); *kernel; ++kernel) {
        const SeriesOfCall series = series_by(**kernel);
        EXPECT_EQ(std::memcmp(&series, &first, sizeof series), 0) << (*kernel)->name << ' ' << n;
      }
      BlockBasis basis;
      DesignSums design;
      SlopeSums slope;
      best_kernel().design_with_slope(input.stamps.data(), n, input.axis, basis, design, slope);
      const double tolerance = 1e-15 * static_cast<double>(n);
      const double* const actual = &first.slope.u;
      const double* const expected = &slope.u;
      for (std::size_t k = 0; k < sizeof slope / sizeof(double); ++k) {
        EXPECT_NEAR(actual[k], expected[k], tolerance) << k;
      }
      EXPECT_NEAR(first.design.sc, design.sc, tolerance);
      for (std::size_t j = 0; j < 2; ++j) {
        ResidualSums residuals;
        ResidualSlopeSums residual_slopes;
        best_kernel().residuals_with_slope(input.pointers[j], n, basis, start[j], residuals,
                                           residual_slopes);
        EXPECT_NEAR(first.residuals[j].es, residuals.es, 5.0 * tolerance);
        EXPECT_NEAR(first.residual_slopes[j].eus, residual_slopes.eus, 5.0 * tolerance);
        EXPECT_NEAR(first.residual_slopes[j].euc, residual_slopes.euc, 5.0 * tolerance);
      }
    }
  }
}

TEST(SampleGrid, TakesBlocksUpToTheFirstThatIsTooFar) {
  const Parameters start{};
  for (const std::size_t late : {std::size_t{5}, std::size_t{300}, std::size_t{1'700}}) {
    Input input(jittering_stamps(grid_call_samples, 60), 1);
    const auto grid = sample_grid(input.stamps, input.frequency);
    ASSERT_TRUE(grid);
    input.stamps[late] += interval_ns / 3;
    DesignSums sums{};
    ResidualSums residuals{};
    for (const SineKernel* const* kernel = supported_kernels(); *kernel; ++kernel) {
      EXPECT_EQ((*kernel)->fit_on_grid(input.stamps.data(), grid_call_samples, input.axis, *grid,
                                       input.pointers.data(), 1, &start, sums, &residuals),
                late / grid_samples * grid_samples);
    }
  }
}

TEST(SampleGrid, TakesNoBlockWhoseStampsDoNotIncrease) {
  const Frequency slow = *Frequency::parse("0.001"); // an interval is a small angle
  const Parameters start{};
  for (std::size_t where = 1; where < grid_samples; ++where) {
    Input input(jittering_stamps(2 * grid_samples, 60), 1);
    const auto grid = sample_grid(input.stamps, slow);
    ASSERT_TRUE(grid);
    input.stamps[where] = input.stamps[where - 1];
    DesignSums sums{};
    ResidualSums residuals{};
    EXPECT_EQ(best_kernel().fit_on_grid(input.stamps.data(), grid_samples, input.axis, *grid,
                                        input.pointers.data(), 1, &start, sums, &residuals),
              0U);
  }
}

TEST(SampleGrid, IsNotMadeForShortRecords) {
  EXPECT_FALSE(sample_grid(jittering_stamps(2 * grid_samples - 1, 60), *Frequency::parse("80")));
}

// Sums of the record in longer arithmetic, with the reduced phase of every sample.
struct LongSums {
  long double a = 0.0L, b = 0.0L, c = 0.0L, rss = 0.0L;

  LongSums(const Frequency& f, const std::vector<std::int64_t>& stamps,
           const std::vector<double>& values, std::int64_t phase_origin_ns) {
    const auto n = static_cast<long double>(stamps.size());
    std::vector<long double> sine, cosine;
    long double s = 0.0L, k = 0.0L, ss = 0.0L, sk = 0.0L, y1 = 0.0L, ys = 0.0L, yk = 0.0L;
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      const auto dt = static_cast<long double>(stamps[i] - phase_origin_ns);
      const long double turns = dt * f.turns_per_ns_high() + dt * f.turns_per_ns_low();
      const long double x =
          2.0L * std::numbers::pi_v<long double> * (turns - std::nearbyint(turns));
      sine.push_back(std::sin(x));
      cosine.push_back(std::cos(x));
      const long double y = values[i];
      s += sine[i];
      k += cosine[i];
      ss += sine[i] * sine[i];
      sk += sine[i] * cosine[i];
      y1 += y;
      ys += y * sine[i];
      yk += y * cosine[i];
    }
    const long double aa = ss - s * s / n, ab = sk - s * k / n, bb = n - ss - k * k / n;
    const long double u = ys - s * y1 / n, v = yk - k * y1 / n;
    a = (bb * u - ab * v) / (aa * bb - ab * ab);
    b = (aa * v - ab * u) / (aa * bb - ab * ab);
    c = (y1 - a * s - b * k) / n;
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      const long double e = static_cast<long double>(values[i]) - a * sine[i] - b * cosine[i] - c;
      rss += e * e;
    }
  }
};

TEST(SampleGrid, KeepsTwelveDigitsOfParametersAndNineOfTheResiduals) {
  const Frequency f = *Frequency::parse("80.02");
  for (const double noise : {1.0, 1e-2, 1.5e-3, 9e-4, 1e-5, 1e-6}) {
    for (const std::size_t n : {std::size_t{1'000}, std::size_t{30'011}, std::size_t{100'000}}) {
      Signal signal;
      signal.frequency_hz = "80.02";
      auto stamps = jittering_stamps(n, 60);
      for (std::size_t i = n / 2; i < n; ++i) {
        stamps[i] += 123'456'789; // a gap within a block
      }
      const auto values = noisy(values_of(signal, stamps), noise, 5);
      const LongSums expected(f, stamps, values, epoch_ns);
      const std::span<const double> channels[] = {values};
      const auto fit = fit_sine(f, epoch_ns, stamps, channels);
      ASSERT_TRUE(fit) << fit.error().message;
      EXPECT_NEAR(fit->front().sine, static_cast<double>(expected.a), 5e-15) << noise << ' ' << n;
      EXPECT_NEAR(fit->front().cosine, static_cast<double>(expected.b), 5e-15) << noise << ' ' << n;
      EXPECT_NEAR(fit->front().offset, static_cast<double>(expected.c), 5e-15) << noise << ' ' << n;
      EXPECT_NEAR(fit->front().rss / static_cast<double>(expected.rss), 1.0, 5e-10)
          << noise << ' ' << n;
    }
  }
}

} // namespace
} // namespace dyncal::analysis::kernel
