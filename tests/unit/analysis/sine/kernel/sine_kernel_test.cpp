#include "analysis/sine/kernel/sine_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/base/frequency.hpp"
#include "analysis/sine/kernel/composed_fma.hpp"
#include "analysis/sine/sine_solve.hpp"

namespace dyncal::analysis::kernel {
namespace {

template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

struct BlockInput {
  std::vector<std::int64_t> stamps;
  std::vector<std::vector<double>> values;
  std::vector<const double*> pointers;
  std::vector<Parameters> start;
  TimeAxis axis{};

  BlockInput(std::size_t n, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_int_distribution<std::int64_t> step(1, 2'000'000);
    std::normal_distribution<double> value(0.3, 2.0);
    std::int64_t stamp =
        1'700'000'000'123'456'789 + static_cast<std::int64_t>(random() % 1'000'000'000'000'000);
    for (std::size_t i = 0; i < n; ++i) {
      stamps.push_back(stamp += step(random));
    }
    for (int j = 0; j < 5; ++j) {
      values.emplace_back();
      for (std::size_t i = 0; i < n; ++i) {
        values.back().push_back(value(random));
      }
      start.push_back({value(random), value(random), value(random)});
    }
    for (const auto& channel : values) {
      pointers.push_back(channel.data());
    }
    const Frequency f = Frequency::from_hz(std::abs(value(random)) * 100.0 + 1e-3);
    axis = {f.turns_per_ns_high(), f.turns_per_ns_low(),
            stamps.front() - static_cast<std::int64_t>(random() % 1'000'000'000'000'000), 1e-9};
  }
};

TEST(SineKernel, GivesTheSameBitsOnEveryInstructionSet) {
  for (std::size_t n = 1; n <= block_samples; n += n < 40 ? 1 : 59) {
    const BlockInput input(n, static_cast<unsigned>(n));
    BlockBasis first_basis{};
    DesignSums first{};
    SlopeSums first_slope{};
    ASSERT_TRUE(baseline_kernel.design_with_slope(input.stamps.data(), n, input.axis, first_basis,
                                                  first, first_slope));
    for (const SineKernel* const* kernel = supported_kernels(); *kernel; ++kernel) {
      SCOPED_TRACE(std::string((*kernel)->name) + " n = " + std::to_string(n));
      BlockBasis basis{};
      DesignSums sums{};
      SlopeSums slope{};
      EXPECT_TRUE((*kernel)->design(input.stamps.data(), n, input.axis, basis, sums));
      EXPECT_TRUE(same_bits(sums, first));
      EXPECT_TRUE(
          (*kernel)->design_with_slope(input.stamps.data(), n, input.axis, basis, sums, slope));
      EXPECT_TRUE(same_bits(sums, first));
      EXPECT_TRUE(same_bits(slope, first_slope));
      EXPECT_EQ(std::memcmp(basis.sine, first_basis.sine, n * sizeof(double)), 0);
      EXPECT_EQ(std::memcmp(basis.cosine, first_basis.cosine, n * sizeof(double)), 0);
      std::vector<ResidualSums> together(input.start.size());
      EXPECT_TRUE((*kernel)->fit_block(input.stamps.data(), n, input.axis, input.pointers.data(),
                                       input.start.size(), input.start.data(), sums,
                                       together.data()));
      EXPECT_TRUE(same_bits(sums, first));
      for (std::size_t j = 0; j < input.start.size(); ++j) {
        ResidualSums expected{}, actual{};
        ResidualSlopeSums expected_slope{}, actual_slope{};
        baseline_kernel.residuals_with_slope(input.pointers[j], n, first_basis, input.start[j],
                                             expected, expected_slope);
        (*kernel)->residuals(input.pointers[j], n, basis, input.start[j], actual);
        EXPECT_TRUE(same_bits(actual, expected));
        EXPECT_TRUE(same_bits(together[j], expected));
        (*kernel)->residuals_with_slope(input.pointers[j], n, basis, input.start[j], actual,
                                        actual_slope);
        EXPECT_TRUE(same_bits(actual, expected));
        EXPECT_TRUE(same_bits(actual_slope, expected_slope));
      }
    }
  }
}

// What the functions that add to lanes leave.
struct LaneResults {
  BlockBasis basis{};
  std::vector<double> time = std::vector<double>(design_time_sums * lanes, 1.0);
  std::vector<double> residuals = std::vector<double>(2 * block_samples);
  std::vector<double> sums = std::vector<double>(2 * residual_time_sums * lanes, 2.0);
  std::vector<double> design = std::vector<double>(9 * line_design_sums * lanes, 3.0);
  std::vector<double> products = std::vector<double>(2 * 9 * 2 * lanes, 4.0);
  double low[2] = {}, high[2] = {};
  bool repeats[2] = {};

  LaneResults(const SineKernel& kernel, const BlockInput& input, std::size_t n,
              std::size_t first_order) {
    EXPECT_TRUE(kernel.design_with_time(input.stamps.data(), n, input.axis, basis, time.data()));
    for (std::size_t j = 0; j < 2; ++j) {
      kernel.residuals_with_time(input.pointers[j], n, basis, input.start[j],
                                 residuals.data() + j * block_samples,
                                 sums.data() + j * residual_time_sums * lanes);
      repeats[j] = kernel.value_range(input.pointers[j], n, low[j], high[j]);
    }
    const double* rows[] = {residuals.data(), residuals.data() + block_samples};
    double* of_channels[] = {products.data(), products.data() + 9 * 2 * lanes};
    kernel.line_sums(basis, n, first_order, 9, rows, 2, design.data(), of_channels);
  }
};

TEST(SineKernel, SumsOfLinesHaveTheSameBitsOnEveryInstructionSet) {
  for (std::size_t n = 1; n <= block_samples; n += n < 40 ? 1 : 59) {
    BlockInput input(n, static_cast<unsigned>(n));
    input.values[1][n / 2] = input.values[1][n > 1 ? n / 2 - 1 : 0]; // equal neighbours
    input.axis.inverse_scale = 1e-15;
    for (const std::size_t first_order : {1UL, 2UL, 3UL}) {
      const LaneResults expected(baseline_kernel, input, n, first_order);
      EXPECT_EQ(expected.low[0], *std::min_element(input.values[0].begin(), input.values[0].end()));
      EXPECT_EQ(expected.high[1],
                *std::max_element(input.values[1].begin(), input.values[1].end()));
      EXPECT_FALSE(expected.repeats[0]);
      EXPECT_EQ(expected.repeats[1], n > 1);
      for (const SineKernel* const* kernel = supported_kernels(); *kernel; ++kernel) {
        SCOPED_TRACE(std::string((*kernel)->name) + " n = " + std::to_string(n));
        const LaneResults actual(**kernel, input, n, first_order);
        EXPECT_TRUE(same_bits(actual.basis, expected.basis));
        EXPECT_EQ(actual.time, expected.time);
        EXPECT_EQ(actual.residuals, expected.residuals);
        EXPECT_EQ(actual.sums, expected.sums);
        EXPECT_EQ(actual.design, expected.design);
        EXPECT_EQ(actual.products, expected.products);
        for (std::size_t j = 0; j < 2; ++j) {
          EXPECT_EQ(actual.low[j], expected.low[j]);
          EXPECT_EQ(actual.high[j], expected.high[j]);
          EXPECT_EQ(actual.repeats[j], expected.repeats[j]);
        }
      }
    }
  }
}

TEST(SineKernel, ReducesPhasesOfMonthsToRounding) {
  const Frequency f = *Frequency::parse("199.87");
  std::vector<std::int64_t> stamps;
  std::mt19937_64 random(4);
  const std::int64_t origin = 1'700'000'000'000'000'000;
  for (std::size_t i = 0; i < block_samples; ++i) {
    stamps.push_back(origin - (std::int64_t{1} << 50) +
                     static_cast<std::int64_t>(i) * (std::int64_t{1} << 42) +
                     static_cast<std::int64_t>(random() % 1'000'000'000));
  }
  const TimeAxis axis{f.turns_per_ns_high(), f.turns_per_ns_low(), origin, 1e-9};
  for (const SineKernel* const* kernel = supported_kernels(); *kernel; ++kernel) {
    BlockBasis basis;
    DesignSums sums;
    ASSERT_TRUE((*kernel)->design(stamps.data(), stamps.size(), axis, basis, sums));
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      const long double x = 2.0L * std::numbers::pi_v<long double> *
                            static_cast<long double>(f.reduced_turns(stamps[i] - origin));
      EXPECT_NEAR(basis.sine[i], static_cast<double>(std::sin(x)), 8e-16)
          << (*kernel)->name; // the reduced phase itself check_nyquist 2e-16 turns
      EXPECT_NEAR(basis.cosine[i], static_cast<double>(std::cos(x)), 8e-16) << (*kernel)->name;
    }
  }
}

TEST(SineKernel, SineAndCosineOfTurnsAreWithinOneAndAThirdEMinus16) {
  long double worst = 0.0L;
  for (int i = -100'000; i <= 100'000; ++i) {
    const double turns = i / 200'000.0;
    const long double x = 2.0L * std::numbers::pi_v<long double> * static_cast<long double>(turns);
    const auto [s, c] = sine_cosine_of_turns(turns);
    worst = std::max({worst, std::abs(static_cast<long double>(s) - std::sin(x)),
                      std::abs(static_cast<long double>(c) - std::cos(x))});
  }
  EXPECT_LT(worst, 1.3e-16L);
}

TEST(SineKernel, SeesEveryStampThatIsNotLater) {
  for (const SineKernel* const* kernel = supported_kernels(); *kernel; ++kernel) {
    for (std::size_t where = 1; where < 40; ++where) {
      for (const std::int64_t back : {std::int64_t{0}, std::int64_t{1}, std::int64_t{1'000'000}}) {
        BlockInput input(40, 9);
        input.stamps[where] = input.stamps[where - 1] - back;
        BlockBasis basis;
        DesignSums sums;
        EXPECT_FALSE((*kernel)->design(input.stamps.data(), 40, input.axis, basis, sums))
            << (*kernel)->name << ' ' << where;
      }
    }
  }
}

// Values and the columns of a model of them, drawn.
struct ColumnModel {
  static constexpr std::size_t count = 11;

  ColumnModel(std::size_t samples, std::mt19937_64& random)
      : columns(count * block_samples), values(samples), coefficients(count) {
    std::normal_distribution<double> value;
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t i = 0; i < samples; ++i) {
        columns[k * block_samples + i] = value(random);
      }
      coefficients[k] = value(random);
    }
    for (double& y : values) {
      y = value(random);
    }
  }

  std::vector<double> columns, values, coefficients;
};

// What a kernel makes of it.
struct ModelSums {
  ModelSums(const SineKernel& kernel, const ColumnModel& model)
      : residuals(block_samples), products(ColumnModel::count) {
    kernel.model_residuals(model.values.data(), model.values.size(), model.columns.data(),
                           ColumnModel::count, model.coefficients.data(), residuals.data(),
                           squares);
    kernel.model_products(residuals.data(), model.values.size(), model.columns.data(),
                          ColumnModel::count, products.data());
  }

  std::vector<double> residuals, products;
  double squares = 0.0;
};

void expect_exact(const ModelSums& sums, const ColumnModel& model) {
  long double squares = 0.0L;
  std::vector<long double> products(ColumnModel::count);
  for (std::size_t i = 0; i < model.values.size(); ++i) {
    long double e = model.values[i];
    for (std::size_t k = 0; k < ColumnModel::count; ++k) {
      e -= static_cast<long double>(model.coefficients[k]) * model.columns[k * block_samples + i];
    }
    ASSERT_NEAR(sums.residuals[i], static_cast<double>(e), 1e-14);
    squares += e * e;
    for (std::size_t k = 0; k < ColumnModel::count; ++k) {
      products[k] += e * model.columns[k * block_samples + i];
    }
  }
  EXPECT_NEAR(sums.squares, static_cast<double>(squares), 1e-14 * sums.squares + 1e-14);
  for (std::size_t k = 0; k < ColumnModel::count; ++k) {
    EXPECT_NEAR(sums.products[k], static_cast<double>(products[k]), 1e-12);
  }
}

TEST(SineKernel, SumsModelsOfManyColumnsWithTheSameBitsOnEveryInstructionSet) {
  std::mt19937_64 random(7);
  for (std::size_t n = 1; n <= block_samples; n += n < 20 ? 1 : 41) {
    const ColumnModel model(n, random);
    const ModelSums first(**supported_kernels(), model);
    expect_exact(first, model);
    for (const SineKernel* const* kernel = supported_kernels(); *kernel; ++kernel) {
      SCOPED_TRACE(std::string((*kernel)->name) + " n = " + std::to_string(n));
      const ModelSums sums(**kernel, model);
      EXPECT_EQ(std::memcmp(sums.residuals.data(), first.residuals.data(), n * sizeof(double)), 0);
      EXPECT_EQ(std::memcmp(sums.products.data(), first.products.data(),
                            ColumnModel::count * sizeof(double)),
                0);
      EXPECT_EQ(sums.squares, first.squares);
    }
  }
}

TEST(SineKernel, RowsPastTheEndDoNotCount) {
  const BlockInput input(13, 5);
  for (const SineKernel* const* kernel = supported_kernels(); *kernel; ++kernel) {
    BlockBasis basis;
    DesignSums sums;
    ASSERT_TRUE((*kernel)->design(input.stamps.data(), 13, input.axis, basis, sums));
    for (std::size_t i = 13; i < 16; ++i) {
      EXPECT_EQ(basis.sine[i], 0.0);
    }
    double s = 0.0;
    for (std::size_t i = 0; i < 13; ++i) {
      s += basis.sine[i];
    }
    EXPECT_NEAR(sums.s, s, 1e-14);
  }
}

TEST(ComposedFma, EqualsTheFusedMultiplyAddBitForBit) {
  std::mt19937_64 random(1);
  const auto any = [&](int spread) {
    const double mantissa = 1.0 + std::ldexp(static_cast<double>(random() >> 12), -52);
    const int exponent =
        static_cast<int>(random() % static_cast<unsigned>(2 * spread + 1)) - spread;
    return std::ldexp(random() % 2 ? mantissa : -mantissa, exponent);
  };
  for (int i = 0; i < 1'000'000; ++i) {
    const double a[2] = {any(200), any(3)};
    const double b[2] = {any(200), any(3)};
    // Mostly cancelling sums, where roundings show.
    const double product = a[1] * b[1];
    const double c[2] = {any(400),
                         i % 3 == 0 ? -product
                                    : (i % 3 == 1 ? -product * (1.0 + any(0) * 1e-16) : any(60))};
    const Double2 result =
        composed_fma(Double2{a[0], a[1]}, Double2{b[0], b[1]}, Double2{c[0], c[1]});
    ASSERT_EQ(result[0], std::fma(a[0], b[0], c[0])) << a[0] << ' ' << b[0] << ' ' << c[0];
    ASSERT_EQ(result[1], std::fma(a[1], b[1], c[1])) << a[1] << ' ' << b[1] << ' ' << c[1];
  }
}

TEST(ComposedFma, KeepsZerosAndNotANumber) {
  const double nan = std::nan("");
  const Double2 zero = composed_fma(Double2{0.0, 3.0}, Double2{5.0, 0.0}, Double2{0.0, 7.0});
  EXPECT_EQ(zero[0], 0.0);
  EXPECT_EQ(zero[1], 7.0);
  EXPECT_TRUE(std::isnan(composed_fma(Double2{nan, 1.0}, Double2{1.0, 1.0}, Double2{1.0, nan})[0]));
  EXPECT_TRUE(std::isnan(composed_fma(Double2{nan, 1.0}, Double2{1.0, 1.0}, Double2{1.0, nan})[1]));
}

} // namespace
} // namespace dyncal::analysis::kernel
