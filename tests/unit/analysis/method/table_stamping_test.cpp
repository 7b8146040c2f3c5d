#include "analysis/method/table_stamping.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180.0;
constexpr double adc_lag_s = 0.19e-6;
constexpr double u_adc_lag_s = 0.03e-6;

struct Step {
  double frequency_hz = 80.0;
  double amplitude = 10.0;
  double phase_rad = 0.0; // of the sensor
  double sync_phase_rad = 0.3;
  double noise = 0.0;
  double sync_noise = 0.0;
  double drift_rel = 0.0; // of the amplitude, from the begin to the end
  double duration_s = 1.0;
};

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> sensor;
  std::vector<double> sync;
};

Record record_of(const Step& step, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Record record;
  const double w = 2.0 * pi * step.frequency_hz;
  std::int64_t stamp_ns = 1'700'000'000'000'000'000;
  const std::int64_t begin_ns = stamp_ns;
  while (stamp_ns - begin_ns < std::llround(1e9 * step.duration_s)) {
    const double t = 1e-9 * static_cast<double>(stamp_ns - begin_ns);
    const double level = 1.0 + step.drift_rel * (t / step.duration_s - 0.5);
    record.stamps_ns.push_back(stamp_ns);
    record.sensor.push_back(9.8 + step.amplitude * level * std::sin(w * t + step.phase_rad) +
                            step.noise * normal(random));
    record.sync.push_back(1.5 + std::sin(w * t + step.sync_phase_rad) +
                          step.sync_noise * normal(random));
    stamp_ns += std::llround(1e9 / 1001.04 + 200.0 * normal(random));
  }
  return record;
}

SampleStampingInput input_of(const Step& step, const Record& record) {
  SampleStampingInput input{.frequency = Frequency::from_hz(step.frequency_hz)};
  const double w = input.frequency.angular();
  input.dau_stamps_ns = record.stamps_ns;
  input.sync_dau = {"dau/sync", record.sync};
  input.dut = {{"dau/z", record.sensor}};
  input.adc = {1.0, w * adc_lag_s, 0.0, w * u_adc_lag_s};
  return input;
}

EvaluatedReference table_row(double amplitude, double phase_rad) {
  return {.channel = "acs/reference",
          .sync_channel = "acs/sync",
          .amplitude = amplitude,
          .u_amplitude = 1e-4 * amplitude,
          .phase_rad = phase_rad,
          .u_phase_rad = 0.02 * degree};
}

SampleStampingResult evaluate(const SampleStampingInput& input,
                              const EvaluatedReference& reference) {
  auto result = evaluate_table_stamping(input, reference);
  EXPECT_TRUE(result.has_value()) << result.error().message;
  return std::move(*result);
}

double u_of(const TransferPoint& point, ContributionKind kind, const std::string& subject,
            double Contribution::*part) {
  double squares = 0.0;
  for (const Contribution& row : point.budget) {
    if (row.kind == kind && row.subject == subject) {
      squares += row.*part * row.*part;
    }
  }
  return std::sqrt(squares);
}

TEST(TableStamping, IsTheEquationWithItsSigns) {
  std::mt19937_64 random(3);
  const Step step{.phase_rad = 1.1, .sync_phase_rad = 0.4};
  const Record record = record_of(step, random);
  SampleStampingInput input = input_of(step, record);
  input.reference_delay_s = 2e-6;
  const SampleStampingResult result = evaluate(input, table_row(8.0, -0.25));
  ASSERT_EQ(result.points.size(), 1U);
  const TransferPoint& point = result.points.front();
  const double w = input.frequency.angular();
  EXPECT_NEAR(point.magnitude, 10.0 / 8.0, 1e-9);
  EXPECT_NEAR(point.phase_rad, 1.1 - 0.4 - w * adc_lag_s - 0.25 - w * 2e-6, 1e-9);
  EXPECT_DOUBLE_EQ(result.reference.fit.amplitude(), 8.0);
  EXPECT_DOUBLE_EQ(result.reference.fit.u_amplitude(), 8e-4);
  EXPECT_NEAR(result.reference.fit.u_phase_rad(), 0.02 * degree, 1e-15);
  EXPECT_NEAR(result.sync_acs.fit.phase_rad(), -0.25, 1e-15);
  EXPECT_EQ(result.sync_acs.fit.u_amplitude(), 0.0);
  EXPECT_EQ(result.sync_dau.channel, "dau/sync");
}

TEST(TableStamping, CountsTheTableOnceAndNotAsAveraging) {
  std::mt19937_64 random(4);
  const Step step;
  const Record record = record_of(step, random);
  const TransferPoint point = evaluate(input_of(step, record), table_row(8.0, 0.1)).points.front();
  EXPECT_NEAR(point.u_magnitude / point.magnitude, 1e-4, 1e-9);
  EXPECT_NEAR(point.u_phase_rad, std::hypot(0.02 * degree, 2.0 * pi * 80.0 * u_adc_lag_s), 1e-9);
  const auto row = std::ranges::find(point.budget, "the reference's table", &Contribution::subject);
  ASSERT_NE(row, point.budget.end());
  EXPECT_EQ(row->repeats, Repeats::common);
}

TEST(TableStamping, RefusesARowWithoutAValue) {
  std::mt19937_64 random(5);
  const Step step;
  const Record record = record_of(step, random);
  const SampleStampingInput input = input_of(step, record);
  for (const auto& spoil : std::vector<std::function<void(EvaluatedReference&)>>{
           [](auto& row) { row.amplitude = 0.0; }, [](auto& row) { row.amplitude = -1.0; },
           [](auto& row) { row.phase_rad = std::nan(""); },
           [](auto& row) { row.u_amplitude = -1e-3; },
           [](auto& row) { row.u_phase_rad = std::nan(""); }}) {
    EvaluatedReference row = table_row(8.0, 0.1);
    spoil(row);
    const auto result = evaluate_table_stamping(input, row);
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().message, "acs/reference has no value");
  }
}

TEST(TableStamping, TakesTheDriftOfTheExciterForAnUnknownOverlap) {
  std::mt19937_64 random(6);
  const Step step{.noise = 0.01, .drift_rel = 0.02, .duration_s = 5.0};
  const Record record = record_of(step, random);
  const SampleStampingInput input = input_of(step, record);
  EvaluatedReference reference = table_row(10.0, 0.0);
  const auto simultaneity = [](const SampleStampingResult& result) {
    return u_of(result.points.front(), ContributionKind::simultaneity, "",
                &Contribution::u_magnitude_rel);
  };
  EXPECT_NEAR(simultaneity(evaluate(input, reference)), 0.02 / std::sqrt(12.0), 2e-4);
  reference.same_window = true;
  EXPECT_EQ(simultaneity(evaluate(input, reference)), 0.0);
}

struct JoinedRow {
  double frequency_hz, amplitude, phase_deg, dau_amplitude, u_dau, dau_phase_rad, u_dau_phase, h,
      u_h, h_deg, u_h_deg;
};

std::vector<JoinedRow> read_join(const std::string& path) {
  std::ifstream file(path);
  std::vector<JoinedRow> rows;
  std::string line, cell;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::vector<double> values;
    while (std::getline(cells, cell, ',')) {
      values.push_back(std::stod(cell));
    }
    rows.push_back({values.at(1), values.at(2), values.at(4), values.at(6), values.at(7),
                    values.at(8), values.at(9), values.at(10), values.at(11), values.at(12),
                    values.at(13)});
  }
  return rows;
}

// Signals without noise: that of the vector's phasors stands in its own columns. The vector was
// made with phases of the table before they were rounded to 1e-4 degrees, and with 1e-4 for u(a_T).
TEST(TableStamping, ReproducesTheSharedVectors) {
  const auto rows = read_join(DYNCAL_SHARED_DATA "/reference/acs_table_join.csv");
  if (rows.empty()) {
    GTEST_SKIP() << "the shared vector reference/acs_table_join.csv is not there";
  }
  ASSERT_EQ(rows.size(), 170U);
  std::mt19937_64 random(7);
  for (const JoinedRow& row : rows) {
    const Step step{.frequency_hz = row.frequency_hz,
                    .amplitude = row.dau_amplitude,
                    .phase_rad = row.dau_phase_rad + 0.3};
    const Record record = record_of(step, random);
    const EvaluatedReference reference = table_row(row.amplitude, row.phase_deg * degree);
    const TransferPoint point = evaluate(input_of(step, record), reference).points.front();
    SCOPED_TRACE(row.frequency_hz);
    EXPECT_NEAR(point.magnitude / row.h, 1.0, 1e-8);
    const double w = 2.0 * pi * row.frequency_hz;
    const double phase_rad = row.dau_phase_rad - w * adc_lag_s + row.phase_deg * degree;
    EXPECT_NEAR(wrap_phase(point.phase_rad - phase_rad), 0.0, 1e-8);
    EXPECT_NEAR(wrap_phase(point.phase_rad - row.h_deg * degree), 0.0, 0.5001e-4 * degree);
    const double u_rel =
        std::hypot(point.u_magnitude / point.magnitude, row.u_dau / row.dau_amplitude);
    EXPECT_NEAR(u_rel * row.h / row.u_h, 1.0, 1e-8);
    EXPECT_NEAR(std::hypot(point.u_phase_rad, row.u_dau_phase) / (row.u_h_deg * degree), 1.0, 1e-8);
  }
}

// 17 frequencies, ten times, as PTB's MPU-9250 was calibrated: the amplitudes of the table are off
// by its own u, and the sensor has noise.
TEST(TableStamping, StatesUncertaintiesThatCoverDrawnTables) {
  const double frequencies_hz[] = {10, 12.5, 16, 20,  25,  31.5, 40,  46.7, 50,
                                   53, 63,   80, 100, 125, 160,  200, 250};
  std::mt19937_64 random(20200907);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> turn(-pi, pi);
  int steps = 0, within_magnitude = 0, within_phase = 0;
  for (int loop = 0; loop < 10; ++loop) {
    for (const double f : frequencies_hz) {
      const double level = std::clamp(0.0274 * f * f, 2.7, 117.0);
      const std::complex<double> h = std::polar(1.02 - 1e-4 * f, -2.0 * pi * f * 1.5e-3);
      const double psi = turn(random), sync = turn(random);
      const double lag_s = adc_lag_s + u_adc_lag_s * normal(random);
      const Step step{.frequency_hz = f,
                      .amplitude = level * std::abs(h),
                      .phase_rad = sync + 2.0 * pi * f * lag_s - psi + std::arg(h),
                      .sync_phase_rad = sync,
                      .noise = 0.08,
                      .sync_noise = 1e-3,
                      .duration_s = 5.0};
      const Record record = record_of(step, random);
      EvaluatedReference reference =
          table_row(level * (1.0 + 1e-4 * normal(random)), psi + 0.02 * degree * normal(random));
      const TransferPoint point = evaluate(input_of(step, record), reference).points.front();
      ++steps;
      within_magnitude += std::abs(point.magnitude - std::abs(h)) < 2.0 * point.u_magnitude;
      within_phase += std::abs(wrap_phase(point.phase_rad - std::arg(h))) < 2.0 * point.u_phase_rad;
    }
  }
  ASSERT_EQ(steps, 170);
  EXPECT_NEAR(100.0 * within_magnitude / steps, 95.0, 3.5);
  EXPECT_NEAR(100.0 * within_phase / steps, 95.0, 3.5);
  RecordProperty("within_magnitude_percent", std::to_string(100.0 * within_magnitude / steps));
  RecordProperty("within_phase_percent", std::to_string(100.0 * within_phase / steps));
}

} // namespace
} // namespace dyncal::analysis
