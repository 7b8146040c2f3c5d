// Records of the shared data: simulated ones whose truth is known to all digits, and real ones of
// two He-Ne interferometers with the correction that their author published.
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/base/phasor.hpp"
#include "analysis/interferometer/record_ellipse.hpp"
#include "tests/unit/analysis/interferometer/simulated_interferometer.hpp"
#include "tests/unit/analysis/interferometer/whole_chain.hpp"

namespace dyncal::analysis {
namespace {

const std::string shared_reference = DYNCAL_SHARED_DATA "/reference/";
constexpr double volt_per_count = 0.000152587890625;

// Columns of int16 of a structured NumPy file, or of one without a head; empty without it.
std::vector<std::vector<std::int16_t>> read_columns(const std::string& name, std::size_t columns) {
  std::ifstream file(shared_reference + name, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  std::vector<std::vector<std::int16_t>> values;
  if (bytes.size() < 10) {
    return values;
  }
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
  const std::size_t header = name.ends_with(".npy") ? 10 + byte(8) + 256u * byte(9) : 0;
  values.resize(columns);
  for (std::size_t at = header; at + 2 * columns <= bytes.size(); at += 2 * columns) {
    for (std::size_t j = 0; j < columns; ++j) {
      values[j].push_back(
          static_cast<std::int16_t>(byte(at + 2 * j) | (byte(at + 2 * j + 1) << 8)));
    }
  }
  return values;
}

#define READ_OR_SKIP(columns, name, count)                                                         \
  const auto columns = read_columns(name, count);                                                  \
  if (columns.empty()) {                                                                           \
    GTEST_SKIP() << "no " << name << " of the shared data beside the source tree";                 \
  }                                                                                                \
  ASSERT_GT((columns)[0].size(), 1000u)

constexpr Ellipse ellipse_of_q1{0.023999353409427545 / volt_per_count,
                                -0.024019774085305493 / volt_per_count, 1.0499998745890455,
                                0.08728709869121443, 0.7999959150488277 / volt_per_count};

struct Expectation {
  double frequency_hz;
  double acceleration_m_s2;
  double sample_rate_hz;
  double within_rel;
  double within_rad;
};

void expect_truth(const std::vector<std::vector<std::int16_t>>& columns,
                  const Expectation& expected, const Ellipse& ellipse) {
  const std::vector<double> sync(columns[2].begin(), columns[2].end());
  const auto result = simulated::chain({expected.frequency_hz, expected.sample_rate_hz,
                                        displacement_per_turn_m(simulated::wavelength_m, 1)},
                                       ellipse, columns[0], columns[1], sync);
  ASSERT_TRUE(result);
  const std::complex<double> truth = std::polar(expected.acceleration_m_s2, 0.4 + std::numbers::pi);
  const std::complex<double> ratio = result->acceleration / truth;
  EXPECT_NEAR(std::abs(ratio), 1.0, expected.within_rel);
  EXPECT_NEAR(std::arg(ratio), 0.0, expected.within_rad);
  EXPECT_NEAR(std::abs(result->sync) * volt_per_count, 1.0, 2e-4);
  EXPECT_NEAR(std::arg(result->sync), 0.9, 2e-4);
  EXPECT_EQ(result->phase.doubtful, 0u);
}

TEST(SharedRecords, ManyFringesWithTheEllipseOfTheRecordItself) {
  READ_OR_SKIP(columns, "quad/q1_160hz_10ms2.npy", 3);
  const auto ellipse = ellipse_of_record(std::span(columns[0]), std::span(columns[1]));
  ASSERT_TRUE(ellipse) << ellipse.error().message;
  EXPECT_EQ(ellipse->fit.method, EllipseMethod::linear);
  EXPECT_NEAR(ellipse->fit.ellipse.r, 1.0499978687311904, 1e-9);
  EXPECT_NEAR(ellipse->fit.ellipse.alpha_rad, 0.08728407222753233, 1e-9);
  EXPECT_NEAR(ellipse->fit.ellipse.radius * volt_per_count, 0.8000052115650008, 1e-9);
  expect_truth(columns, {160.0, 10.0, 1e6, 2e-7, 3e-7}, ellipse->fit.ellipse);
}

TEST(SharedRecords, AnArcOfATenthOfARadianWithTheEllipseOfAnotherStep) {
  READ_OR_SKIP(columns, "quad/q3_10khz_10ms2.npy", 3);
  const auto own = ellipse_of_record(std::span(columns[0]), std::span(columns[1]));
  ASSERT_FALSE(own);
  EXPECT_EQ(own.error().code, ErrorCode::ill_conditioned);
  EXPECT_NE(own.error().message.find("another step"), std::string::npos) << own.error().message;
  expect_truth(columns, {10000.0, 10.0, 2e6, 2e-4, 1e-3}, ellipse_of_q1);
}

TEST(SharedRecords, LessThanOneSampleAFringe) {
  READ_OR_SKIP(columns, "quad/q4_80hz_100ms2_undersampled.npy", 3);
  expect_truth(columns, {80.0, 100.0, 4e5, 1e-8, 1e-8}, ellipse_of_q1);
}

// I and Q of a vibrometer that mixes its beat down are a pair with a nearly perfect circle.
TEST(SharedRecords, TheIAndQOfAVibrometer) {
  READ_OR_SKIP(columns, "iq/q1.sigmf-data", 2);
  const auto ellipse = ellipse_of_record(std::span(columns[0]), std::span(columns[1]));
  ASSERT_TRUE(ellipse) << ellipse.error().message;
  std::vector<double> sync; // the record has none
  for (std::size_t i = 0; i < columns[0].size(); ++i) {
    sync.push_back(std::sin(2.0 * std::numbers::pi * 160.0 * 1e-6 * static_cast<double>(i)));
  }
  const auto result =
      simulated::chain({160.0, 1e6, displacement_per_turn_m(simulated::wavelength_m, 1)},
                       ellipse->fit.ellipse, columns[0], columns[1], sync);
  ASSERT_TRUE(result);
  const std::complex<double> ratio =
      result->acceleration / std::polar(10.0, 0.4 + std::numbers::pi);
  EXPECT_NEAR(std::abs(ratio), 1.0, 1e-6);
  EXPECT_NEAR(std::arg(ratio), 0.0, 1e-6);
  EXPECT_EQ(result->phase.doubtful, 0u);
}

struct PublishedAxis {
  Ellipse ellipse;
  double radius_sd;
  double fourth_harmonic;
};

// The points are sorted by phase: they cover just less than the one turn from which on a record is
// fitted so by itself.
void expect_published(const std::vector<std::vector<std::int16_t>>& columns,
                      const PublishedAxis& published) {
  EllipseMoments moments;
  moments.add(std::span(columns[0]), std::span(columns[1]));
  const auto fit = fit_ellipse_by(EllipseMethod::linear, moments);
  ASSERT_TRUE(fit) << fit.error().message;
  const auto near = [](double value, double expected) {
    EXPECT_NEAR(value / expected, 1.0, 1e-9) << expected;
  };
  const Ellipse& own = fit->ellipse;
  near(own.p, published.ellipse.p);
  near(own.q, published.ellipse.q);
  near(own.r, published.ellipse.r);
  near(own.alpha_rad, published.ellipse.alpha_rad);
  near(own.radius, published.ellipse.radius);
  const kernel::QuadratureCorrection correction = correction_of(own);
  double sum = 0.0;
  double squares = 0.0;
  const auto n = static_cast<double>(columns[0].size());
  for (std::size_t i = 0; i < columns[0].size(); ++i) {
    const double x = columns[0][i] - correction.p;
    const double y = (columns[1][i] - correction.q) * correction.scale + x * correction.tangent;
    const double from_ellipse = std::hypot(x, y) - own.radius;
    sum += from_ellipse;
    squares += from_ellipse * from_ellipse;
  }
  EXPECT_NEAR(std::sqrt((squares - sum * sum / n) / n), published.radius_sd, 1e-6);
  QuadraturePhase phase(own);
  std::vector<double> turns(columns[0].size());
  ASSERT_TRUE(phase.push(std::span(columns[0]), std::span(columns[1]), turns));
  const auto harmonics = phase.radius_over_phase().harmonics();
  ASSERT_TRUE(harmonics);
  EXPECT_NEAR(harmonics->amplitude[3], published.fourth_harmonic, 0.01 * published.fourth_harmonic);
  EXPECT_LT(harmonics->amplitude[0], 0.02 * published.fourth_harmonic);
  EXPECT_LT(harmonics->amplitude[1], 0.02 * published.fourth_harmonic);
}

TEST(SharedRecords, RealInterferometerAlongX) {
  READ_OR_SKIP(columns, "nmm/nmm_X.npy", 2);
  expect_published(columns, {{2.4611063003438707, -0.40493350838220393, 1.0073863759422639,
                              0.009161912788375602, 501.20192848987546},
                             2.0209855308471387,
                             2.66});
}

TEST(SharedRecords, RealInterferometerAlongY) {
  READ_OR_SKIP(columns, "nmm/nmm_Y.npy", 2);
  expect_published(columns, {{-1.062922441047185, 1.0209879661498522, 0.9992452981126598,
                              -0.011710044385883784, 533.9520129914592},
                             11.999106794857655,
                             15.4});
}

} // namespace
} // namespace dyncal::analysis
