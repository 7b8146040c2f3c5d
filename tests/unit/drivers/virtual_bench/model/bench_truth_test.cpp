// What the bench's instruments record, evaluated by eq. (3) and (4), must give what the bench says
// is true.
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <numbers>

#include "analysis/method/sample_stamping.hpp"
#include "drivers/virtual_bench/model/truth.hpp"
#include "drivers/virtual_bench/model/virtual_bench.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

struct Recording {
  std::vector<std::int64_t> acs_stamps_ns;
  std::vector<double> reference;
  std::vector<double> sync_acs;
  std::vector<std::int64_t> dau_stamps_ns;
  std::array<std::vector<double>, 3> acceleration;
  std::vector<double> sync_dau;
};

// Samples of `duration_s` from now on, in slices of `slice_s`.
Recording record(VirtualBench& bench, double duration_s, double slice_s) {
  Recording recording;
  AcsSamples acs;
  const double end_s = bench.now_s() + duration_s;
  while (bench.now_s() < end_s) {
    bench.advance_to(std::min(end_s, bench.now_s() + slice_s), acs, [&](const UnitSample& sample) {
      recording.dau_stamps_ns.push_back(sample.utc_ns);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        recording.acceleration[axis].push_back(static_cast<double>(*sample.data[axis]));
      }
      recording.sync_dau.push_back(static_cast<double>(*sample.data[10]));
    });
  }
  for (std::size_t i = 0; i < acs.samples(); ++i) {
    recording.acs_stamps_ns.push_back(bench.acs().stamp_ns(acs.first_sample + i));
    recording.reference.push_back(acs.counts[2 * i] * bench.acs().reference_scale());
    recording.sync_acs.push_back(acs.counts[2 * i + 1] * bench.acs().sync_scale());
  }
  return recording;
}

BenchSettings settings(const std::string& preset, std::uint64_t seed) {
  BenchSettings result;
  result.preset = *preset_by_name(preset);
  result.seed = seed;
  result.highest_level_m_s2 = 20.0;
  return result;
}

analysis::SampleStampingInput input_of(const Recording& recording, const VirtualBench& bench,
                                       const std::string& frequency) {
  analysis::SampleStampingInput input{.frequency = *analysis::Frequency::parse(frequency)};
  input.acs_stamps_ns = recording.acs_stamps_ns;
  input.reference = {"reference", recording.reference, 0.0};
  input.sync_acs = {"sync", recording.sync_acs, 0.0};
  input.dau_stamps_ns = recording.dau_stamps_ns;
  input.sync_dau = {"sync", recording.sync_dau, 0.0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    input.dut.push_back({std::string(1, "xyz"[axis]), recording.acceleration[axis], 0.0});
  }
  input.adc.gain = bench.adc().gain;
  input.adc.phase_lag_rad = 2.0 * std::numbers::pi * input.frequency.hz() * bench.adc().lag_s;
  input.systematic.dau_jitter_s = 20e-9;
  return input;
}

class BenchTruth : public testing::TestWithParam<const char*> {};

TEST_P(BenchTruth, AgreesWithTheEvaluationOfTheSamples) {
  VirtualBench bench(settings(GetParam(), 42));
  const std::complex<double> reference_error =
      std::polar(1.0 + bench.acs().reference_gain_error(), bench.acs().reference_phase_error_rad());
  for (const char* frequency : {"12.5", "63", "160"}) {
    bench.set_drive({std::strtod(frequency, nullptr), 0.3, true});
    record(bench, 0.6, 0.02); // settling
    const Recording recording = record(bench, 4.0, 0.02);
    bench.set_drive({100.0, 0.0, false});
    record(bench, 0.3, 0.02);
    const auto result = analysis::evaluate_sample_stamping(input_of(recording, bench, frequency));
    ASSERT_TRUE(result) << result.error().message;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const analysis::TransferPoint& point = result->points[axis];
      const std::complex<double> truth =
          bench.settings().preset.axes[axis].at(std::strtod(frequency, nullptr)) / reference_error;
      const std::complex<double> ratio = point.h / truth;
      // 1e-4: harmonics and hum that a window of other length weighs differently in both systems.
      EXPECT_NEAR(std::abs(ratio), 1.0, 4.0 * point.u_magnitude / point.magnitude + 1e-4)
          << frequency << " Hz, axis " << axis;
      EXPECT_NEAR(std::arg(ratio), 0.0, 4.0 * point.u_phase_rad + 1e-4)
          << frequency << " Hz, axis " << axis;
      EXPECT_LT(point.u_magnitude / point.magnitude, axis == 2 ? 2e-3 : 0.1);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EveryPreset, BenchTruth,
                         testing::Values("mpu9250-paper", "mpu9250-ptb", "bma280"));

TEST(VirtualBench, GivesTheSameSamplesHoweverTimeIsCut) {
  VirtualBench coarse(settings("mpu9250-paper", 5));
  VirtualBench fine(settings("mpu9250-paper", 5));
  coarse.set_drive({40.0, 0.2, true});
  fine.set_drive({40.0, 0.2, true});
  const Recording a = record(coarse, 1.0, 0.1);
  const Recording b = record(fine, 1.0, 0.0037);
  EXPECT_EQ(a.acs_stamps_ns, b.acs_stamps_ns);
  EXPECT_EQ(a.reference, b.reference);
  EXPECT_EQ(a.sync_acs, b.sync_acs);
  EXPECT_EQ(a.dau_stamps_ns, b.dau_stamps_ns);
  EXPECT_EQ(a.acceleration[2], b.acceleration[2]);
  EXPECT_EQ(a.sync_dau, b.sync_dau);
}

TEST(VirtualBench, ClocksOfAcsAndDauShareNeitherEpochNorRate) {
  VirtualBench bench(settings("mpu9250-paper", 9));
  VirtualBench other(settings("mpu9250-paper", 10));
  EXPECT_NE(bench.acs().stamp_ns(0), other.acs().stamp_ns(0));
  EXPECT_NE(bench.unit().clock().start_ns(), other.unit().clock().start_ns());
  EXPECT_GT(bench.unit().clock().start_ns() - bench.acs().stamp_ns(0), 1'000'000'000'000'000'000);
  EXPECT_NE(bench.acs().rate_error(), 0.0);
  EXPECT_LE(std::abs(bench.acs().rate_error()), 0.5e-6);
}

TEST(VirtualBench, IsSilentWhileTheGeneratorIsOff) {
  VirtualBench bench(settings("mpu9250-paper", 5));
  const Recording recording = record(bench, 0.5, 0.05);
  for (const double sync_v : recording.sync_acs) {
    ASSERT_LT(std::abs(sync_v), 1e-3);
  }
}

TEST(VirtualBench, AccelerationSettlesAfterAChange) {
  VirtualBench bench(settings("mpu9250-paper", 5));
  bench.set_drive({40.0, 0.2, true});
  const auto largest = [](const std::vector<double>& values) {
    return std::abs(*std::max_element(values.begin(), values.end(), [](double a, double b) {
      return std::abs(a) < std::abs(b);
    }));
  };
  const double at_once = largest(record(bench, 0.01, 0.01).reference);
  record(bench, 0.5, 0.05);
  const double settled = largest(record(bench, 0.1, 0.05).reference);
  EXPECT_LT(at_once, 0.5 * settled);
  EXPECT_NEAR(settled, 10.0, 0.5);
}

TEST(Truth, NamesEveryAxisAtEveryFrequency) {
  const VirtualBench bench(settings("bma280", 5));
  const std::string truth = truth_json(bench, {"10", "12.5"});
  EXPECT_NE(truth.find("\"acceleration_x\""), std::string::npos);
  EXPECT_NE(truth.find("\"frequency_text_hz\": \"12.5\""), std::string::npos);
  const std::string adc = adc_calibration_json(bench, {"10", "12.5"});
  EXPECT_NE(adc.find("\"12.5\": ["), std::string::npos);
  EXPECT_NE(adc.find("\"10.0\": ["), std::string::npos);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
