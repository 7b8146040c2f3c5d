#include "analysis/method/motion_channel.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/method/analogue_comparison.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double frequency_hz = 159.2;
constexpr double rate_hz = 20000.0;
constexpr double seconds = 1.0;
constexpr double acceleration_m_s2 = 2.0;
const std::complex<double> true_h = std::polar(0.4, -0.7); // per m/s^2

// What one digitiser records: the table's random walk and drift beside the excitation, which is far
// smaller, in displacement and velocity, and a sensor of acceleration.
struct Bench {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> displacement;
  std::vector<double> velocity;
  std::vector<double> sync;
  std::vector<double> dut;
};

Bench bench(unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double w = 2.0 * pi * frequency_hz;
  double table_m_s = 0.0, table_m = 0.0;
  Bench result;
  for (int i = 0; i < static_cast<int>(rate_hz * seconds); ++i) {
    const double t = i / rate_hz;
    table_m_s += 0.05 * normal(random) / rate_hz;
    table_m += (table_m_s + 1e-6) / rate_hz;
    result.stamps_ns.push_back(1'700'000'000'000'000'000 + std::llround(t * 1e9));
    result.displacement.push_back(-acceleration_m_s2 / (w * w) * std::sin(w * t) + table_m +
                                  1e-11 * normal(random));
    result.velocity.push_back(-acceleration_m_s2 / w * std::cos(w * t) + table_m_s + 0.01 +
                              1e-7 * normal(random));
    result.sync.push_back(std::sin(w * t + 0.9) + 1e-4 * normal(random));
    result.dut.push_back(acceleration_m_s2 * std::abs(true_h) * std::sin(w * t + std::arg(true_h)) +
                         1e-4 * normal(random));
  }
  return result;
}

AnalogueInput input_of(const Bench& bench, MotionQuantity measured, MotionQuantity per) {
  AnalogueInput input{.frequency = *Frequency::parse("159.2")};
  input.stamps_ns = bench.stamps_ns;
  input.reference = {"reference", measured == MotionQuantity::displacement ? bench.displacement
                                                                           : bench.velocity};
  input.reference.motion = {measured, per};
  input.sync = ChannelSamples{"sync", bench.sync};
  input.dut = {{"dut", bench.dut}};
  return input;
}

TEST(MotionChannel, DisplacementAndVelocityAreTakenWithoutTheMotionOfTheTable) {
  for (const auto measured : {MotionQuantity::displacement, MotionQuantity::velocity}) {
    constexpr int runs = 50;
    double magnitude = 0.0, phase = 0.0;
    for (unsigned run = 0; run < runs; ++run) {
      const Bench one = bench(run + 1);
      const auto result = evaluate_analogue(input_of(one, measured, MotionQuantity::acceleration));
      ASSERT_TRUE(result) << result.error().message;
      const TransferPoint& point = result->points[0];
      const std::complex<double> off = point.h / true_h;
      magnitude += std::pow((std::abs(off) - 1.0) * point.magnitude / point.u_magnitude, 2) / runs;
      phase += std::pow(std::arg(off) / point.u_phase_rad, 2) / runs;
      EXPECT_LT(point.u_magnitude / point.magnitude, 3e-3);
    }
    EXPECT_GT(std::sqrt(magnitude), 0.7) << to_string(measured);
    EXPECT_LT(std::sqrt(magnitude), 1.4) << to_string(measured);
    EXPECT_GT(std::sqrt(phase), 0.7) << to_string(measured);
    EXPECT_LT(std::sqrt(phase), 1.4) << to_string(measured);
  }
}

TEST(MotionChannel, TheResponseIsPerTheQuantityThatIsAskedFor) {
  const Bench one = bench(7);
  const double w = 2.0 * pi * frequency_hz;
  const std::complex<double> per_velocity = true_h * std::complex<double>(0.0, w);
  const std::complex<double> per_displacement = -w * w * true_h;
  for (const auto measured : {MotionQuantity::displacement, MotionQuantity::velocity}) {
    const auto of = [&](MotionQuantity per) {
      const auto result = evaluate_analogue(input_of(one, measured, per));
      EXPECT_TRUE(result);
      return result ? result->points[0].h : 0.0;
    };
    EXPECT_LT(std::abs(of(MotionQuantity::acceleration) / true_h - 1.0), 1e-3);
    EXPECT_LT(std::abs(of(MotionQuantity::velocity) / per_velocity - 1.0), 1e-3);
    EXPECT_LT(std::abs(of(MotionQuantity::displacement) / per_displacement - 1.0), 1e-3);
  }
}

TEST(MotionChannel, TheReferenceIsReportedInItsOwnUnit) {
  const Bench one = bench(8);
  const auto result =
      evaluate_analogue(input_of(one, MotionQuantity::displacement, MotionQuantity::acceleration));
  ASSERT_TRUE(result);
  const double w = 2.0 * pi * frequency_hz;
  EXPECT_NEAR(result->reference.fit.amplitude() * w * w / acceleration_m_s2, 1.0, 1e-3);
  EXPECT_EQ(result->reference.channel, "reference");
}

TEST(MotionChannel, FindsTheFrequencyWithoutSync) {
  const Bench one = bench(9);
  AnalogueInput input = input_of(one, MotionQuantity::displacement, MotionQuantity::acceleration);
  input.sync.reset();
  const auto result = evaluate_analogue(input);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_NEAR(result->reference.frequency.hz() / frequency_hz, 1.0, 1e-6);
  EXPECT_LT(std::abs(result->points[0].h / true_h - 1.0), 1e-3);
}

TEST(MotionChannel, TheFrequencyCountsWhereAnotherQuantityIsMadeWithIt) {
  const Bench one = bench(10);
  AnalogueInput input = input_of(one, MotionQuantity::displacement, MotionQuantity::acceleration);
  input.frequency = *Frequency::parse("159.1"); // 0.063 % below: squared
  const auto result = evaluate_analogue(input);
  ASSERT_TRUE(result) << result.error().message;
  double u = 0.0;
  for (const Contribution& row : result->points[0].budget) {
    u += row.kind == ContributionKind::motion_frequency ? row.u_magnitude_rel : 0.0;
  }
  EXPECT_NEAR(u, 2.0 * 0.1 / 159.1 / std::sqrt(3.0), 1e-6);
}

TEST(MotionChannel, NamesTheChannelThatIsSampledTooSlowly) {
  Bench one = bench(11);
  AnalogueInput input = input_of(one, MotionQuantity::displacement, MotionQuantity::acceleration);
  std::vector<std::int64_t> stamps;
  std::vector<double> values, sync, dut;
  for (std::size_t i = 0; i < one.stamps_ns.size(); i += 40) { // 500 Hz
    stamps.push_back(one.stamps_ns[i]);
    values.push_back(one.displacement[i]);
    sync.push_back(one.sync[i]);
    dut.push_back(one.dut[i]);
  }
  input.stamps_ns = stamps;
  input.reference.values = values;
  input.sync->values = sync;
  input.dut[0].values = dut;
  const auto result = evaluate_analogue(input);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::frequency_out_of_range);
  EXPECT_TRUE(result.error().message.starts_with("reference: ")) << result.error().message;
}

} // namespace
} // namespace dyncal::analysis
