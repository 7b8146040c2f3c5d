// Problems of the NIST Statistical Reference Datasets through the command that people run:
// `dyncal fit`, for those that are sines or polynomials. The nonlinear ones that are neither are
// judged in tests/unit/analysis/response/least_squares_test.cpp by the solver of `dyncal model`.
#include "tests/reference_datasets.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

class ReferenceDatasets : public testing::Test {
protected:
  std::filesystem::path folder = fresh_folder(
      std::string("nist-") + testing::UnitTest::GetInstance()->current_test_info()->name());

  // x is in seconds: a month of ENSO is one.
  std::filesystem::path file(int first_x, const std::vector<double>& y) {
    const std::filesystem::path path = folder / "data.csv";
    std::ofstream stream(path);
    stream << "t_ns,y\n";
    for (std::size_t i = 0; i < y.size(); ++i) {
      stream << fmt::format("{},{:.17g}\n",
                            std::int64_t{1'000'000'000} * (first_x + static_cast<int>(i)), y[i]);
    }
    return path;
  }
  nlohmann::json fit(const std::filesystem::path& data, std::vector<std::string> options) {
    options.insert(options.begin(), {"fit", data, "--reference-time", "0", "--json"});
    ProgramRun run("dyncal", options, folder);
    EXPECT_EQ(run.wait(patience), 0) << run.errors();
    return nlohmann::json::parse(run.output(), nullptr, false)["columns"]["y"];
  }
};

std::string frequency_of(double period) {
  return fmt::format("{:.17g}", 1.0 / period);
}

// Each of the three cycles as the sine, the others as further lines.
TEST_F(ReferenceDatasets, FitMeetsEnso) {
  const auto data = file(1, enso_pressure);
  const std::vector<double>& b = enso_parameters;
  struct Cycle {
    double period, cosine, sine;
  };
  const std::vector<Cycle> cycles{{12.0, b[1], b[2]}, {b[3], b[4], b[5]}, {b[6], b[7], b[8]}};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto y = fit(data, {"--frequency", frequency_of(cycles[i].period), "--hum",
                              frequency_of(cycles[(i + 1) % 3].period), "--hum",
                              frequency_of(cycles[(i + 2) % 3].period)});
    EXPECT_NEAR(y["B_cos"].get<double>() / cycles[i].cosine, 1.0, 1e-8);
    EXPECT_NEAR(y["A_sin"].get<double>() / cycles[i].sine, 1.0, 1e-8);
    EXPECT_NEAR(y["C"].get<double>() / b[0], 1.0, 1e-9);
    EXPECT_NEAR(y["rss"].get<double>() / enso_rss, 1.0, 1e-9);
    EXPECT_EQ(y["samples"], 168);
  }
}

// The certified periods are where the residuals of `dyncal fit` are smallest.
TEST_F(ReferenceDatasets, FitHasItsMinimumAtTheCertifiedPeriodsOfEnso) {
  const auto data = file(1, enso_pressure);
  const double long_cycle = enso_parameters[3], short_cycle = enso_parameters[6];
  const auto rss = [&](double scale_long, double scale_short) {
    return fit(data,
               {"--frequency", frequency_of(12.0), "--hum", frequency_of(long_cycle * scale_long),
                "--hum", frequency_of(short_cycle * scale_short)})["rss"]
        .get<double>();
  };
  for (const double step : {1e-3, 1e-2}) {
    const double below = rss(1.0 - step, 1.0), above = rss(1.0 + step, 1.0);
    EXPECT_GT(below, enso_rss);
    EXPECT_GT(above, enso_rss);
    EXPECT_NEAR((above - enso_rss) / (below - enso_rss), 1.0, 100.0 * step);
    EXPECT_GT(rss(1.0, 1.0 - step), enso_rss);
    EXPECT_GT(rss(1.0, 1.0 + step), enso_rss);
  }
}

// Wampler1 and Wampler2, exact polynomials of fifth order at x = 0 ... 20, as the drift of a sine.
TEST_F(ReferenceDatasets, FitTakesWamplersPolynomialsAsDrift) {
  for (const double ratio : {1.0, 0.1}) {
    std::vector<double> polynomial;
    for (int x = 0; x <= 20; ++x) {
      double value = 0.0;
      for (int power = 5; power >= 0; --power) {
        value = value * x + std::pow(ratio, power);
      }
      polynomial.push_back(value);
    }
    const double amplitude = 0.1 * polynomial.back();
    std::vector<double> y = polynomial;
    for (std::size_t x = 0; x < y.size(); ++x) {
      y[x] += amplitude * std::sin(2.0 * std::numbers::pi * 0.21 * static_cast<double>(x));
    }
    const double squares = std::inner_product(y.begin(), y.end(), y.begin(), 0.0);
    const auto found = fit(file(0, y), {"--frequency", "0.21", "--drift", "5"});
    EXPECT_LT(found["rss"].get<double>(), 1e-22 * squares);
    EXPECT_NEAR(found["A_sin"].get<double>() / amplitude, 1.0, 1e-10);
    EXPECT_NEAR(found["B_cos"].get<double>() / amplitude, 0.0, 1e-10);
  }
}

} // namespace
} // namespace dyncal::tests
