// What the virtual interferometer records, demodulated by analysis/interferometer, must give what
// the bench says is true.
#include "drivers/virtual_bench/model/interferometer.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/interferometer/quadrature_phase.hpp"
#include "analysis/interferometer/record_ellipse.hpp"
#include "analysis/interferometer/reference_motion.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "drivers/virtual_bench/model/virtual_bench.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double wavelength_m = 632.82e-9;
constexpr double u_wavelength_rel = 1.6e-6;
constexpr double noise_rel = 2e-3; // of the radius

BenchSettings settings(std::uint64_t seed) {
  BenchSettings result;
  result.preset = *preset_by_name("mpu9250-ptb");
  result.seed = seed;
  result.acs_rate_hz = 500'000;
  result.interferometer =
      InterferometerSettings{.wavelength_m = wavelength_m, .u_wavelength_rel = u_wavelength_rel};
  return result;
}

struct Recording {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> u1;
  std::vector<double> u2;
  std::vector<double> sync;
};

Recording record(VirtualBench& bench, double duration_s, double slice_s = 0.05) {
  AcsSamples acs;
  const double end_s = bench.now_s() + duration_s;
  while (bench.now_s() < end_s) {
    bench.advance_to(std::min(end_s, bench.now_s() + slice_s), acs, [](const UnitSample&) {});
  }
  Recording recording;
  const auto& channels = bench.acs().channels();
  for (std::size_t i = 0; i < acs.samples(); ++i) {
    recording.stamps_ns.push_back(bench.acs().stamp_ns(acs.first_sample + i));
    recording.u1.push_back(acs.counts[3 * i] * channels[0].scale);
    recording.u2.push_back(acs.counts[3 * i + 1] * channels[1].scale);
    recording.sync.push_back(acs.counts[3 * i + 2] * channels[2].scale);
  }
  return recording;
}

const InterferometerTruth& truth_of(const VirtualBench& bench) {
  return bench.acs().interferometer()->truth();
}

TEST(Interferometer, LiesOnTheEllipseThatWasDrawn) {
  double squares = 0.0;
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    VirtualBench bench(settings(seed));
    bench.set_drive({80.0, 0.2, true});
    const Recording recording = record(bench, 0.2);
    const auto found = analysis::ellipse_of_record(recording.u1, recording.u2);
    ASSERT_TRUE(found) << found.error().message;
    const InterferometerTruth& truth = truth_of(bench);
    const analysis::Ellipse& ellipse = found->fit.ellipse;
    const double deviations[] = {ellipse.p - truth.p_v, ellipse.q - truth.q_v, ellipse.r - truth.r,
                                 ellipse.alpha_rad - truth.alpha_rad,
                                 ellipse.radius - truth.radius_v};
    for (std::size_t i = 0; i < 5; ++i) {
      const double u = std::sqrt(found->fit.covariance[i][i]);
      EXPECT_LT(std::abs(deviations[i]), 4.5 * u) << "parameter " << i << ", seed " << seed;
      squares += deviations[i] * deviations[i] / (u * u);
      ++compared;
    }
    EXPECT_NEAR(found->fit.noise_sd_1, noise_rel * truth.radius_v, 1e-4);
    EXPECT_GT(std::abs(truth.p_v), 0.014 * truth.radius_v);
    EXPECT_LT(std::abs(truth.p_v), 0.046 * truth.radius_v);
    EXPECT_GT(std::abs(truth.r - 1.0), 0.024);
    EXPECT_GT(std::abs(truth.alpha_rad), 0.04);
    EXPECT_NEAR(truth.wavelength_m / wavelength_m, 1.0, 5.0 * u_wavelength_rel);
  }
  EXPECT_GT(std::sqrt(squares / compared), 0.6); // no needless doubt
  EXPECT_LT(std::sqrt(squares / compared), 1.4);
}

// Where nothing but the table's slow motion is left, the displacement is that of the table with the
// noise of the photodiodes: sd_u / R in phase.
TEST(Interferometer, ShowsTheTableWithTheNoiseOfItsDiodes) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    VirtualBench bench(settings(seed));
    record(bench, 0.37);
    const double begin_s = bench.now_s();
    const Recording recording = record(bench, 1.0);
    const InterferometerTruth& truth = truth_of(bench);
    analysis::QuadraturePhase phase(
        {truth.p_v, truth.q_v, truth.r, truth.alpha_rad, truth.radius_v});
    std::vector<double> turns(recording.u1.size());
    ASSERT_TRUE(phase.push(recording.u1, recording.u2, turns));
    EXPECT_EQ(phase.statistics().doubtful, 0U);
    const TableDrift& drift = bench.acs().interferometer()->drift();
    const double interval_s = (1.0 + bench.acs().rate_error()) / 500e3;
    const double first_s = std::ceil(begin_s / interval_s) * interval_s;
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < turns.size(); ++i) {
      const double at_s = first_s + static_cast<double>(i) * interval_s;
      const double deviation_m = turns[i] * truth.wavelength_m / 2.0 - drift.at(at_s);
      sum += deviation_m;
      squares += deviation_m * deviation_m;
    }
    const auto count = static_cast<double>(turns.size());
    const double sd_m = std::sqrt(squares / count - (sum / count) * (sum / count));
    const double expected_m = noise_rel * truth.wavelength_m / (4.0 * std::numbers::pi);
    EXPECT_GT(phase.statistics().turns_covered(), 0.3); // the table moves
    EXPECT_NEAR(sd_m, expected_m, 0.05 * expected_m) << "seed " << seed;
  }
}

// Reference over sync, as the analogue system shows it.
struct Evaluated {
  std::complex<double> ratio; // m/s^2 per V
  double u_rel = 0.0;         // of the fits alone
};

analysis::SineFit fit_of(const analysis::Frequency& frequency, const Recording& recording,
                         const std::vector<double>& values, double& noise_factor) {
  const auto motion = analysis::motion_of_step(analysis::MotionQuantity::displacement, frequency,
                                               recording.stamps_ns, values);
  EXPECT_TRUE(motion);
  const std::span<const double> channels[] = {motion->values};
  const auto fits =
      analysis::fit_sine(frequency, recording.stamps_ns.front(), motion->stamps_ns, channels);
  EXPECT_TRUE(fits);
  noise_factor = motion->noise_factor;
  return fits->front();
}

// With nothing known but what a laboratory knows: the nominal wavelength, and the ellipse of the
// record itself.
Evaluated evaluate(const Recording& recording, const analysis::Frequency& frequency) {
  const auto found = analysis::ellipse_of_record(recording.u1, recording.u2);
  EXPECT_TRUE(found) << found.error().message;
  analysis::QuadraturePhase phase(found->fit.ellipse);
  std::vector<double> displacement_m(recording.u1.size());
  EXPECT_TRUE(phase.push(recording.u1, recording.u2, displacement_m));
  EXPECT_EQ(phase.statistics().doubtful, 0U);
  for (double& value : displacement_m) {
    value *= analysis::displacement_per_turn_m(wavelength_m, 1);
  }
  double noise_factor = 1.0;
  const analysis::SineFit sync = fit_of(frequency, recording, recording.sync, noise_factor);
  const analysis::SineFit moved = fit_of(frequency, recording, displacement_m, noise_factor);
  const double w = frequency.angular();
  return {-w * w * std::polar(moved.amplitude(), moved.phase_rad()) /
              std::polar(sync.amplitude(), sync.phase_rad()),
          std::hypot(noise_factor * moved.u_amplitude() / moved.amplitude(),
                     sync.u_amplitude() / sync.amplitude())};
}

TEST(Interferometer, GivesTheAccelerationOfTheExciterWithinItsUncertainty) {
  constexpr double amplitude_v = 0.05;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const char* text : {"10", "80", "160", "1000"}) {
      VirtualBench bench(settings(seed));
      const analysis::Frequency frequency = *analysis::Frequency::parse(text);
      bench.set_drive({frequency.hz(), amplitude_v, true});
      record(bench, 0.7);
      const Evaluated result = evaluate(record(bench, 1.0), frequency);
      const std::complex<double> seen = std::polar(1.0 + bench.acs().reference_gain_error(),
                                                   bench.acs().reference_phase_error_rad());
      const std::complex<double> deviation =
          result.ratio * VirtualBench::sync_amplitude_v /
          (seen * amplitude_v * bench.exciter().at(frequency.hz()));
      const double magnitude =
          (std::abs(deviation) - 1.0) / std::hypot(result.u_rel, u_wavelength_rel);
      const double phase =
          (std::arg(deviation) + frequency.angular() * truth_of(bench).detector_delay_s) /
          result.u_rel;
      EXPECT_LT(std::abs(magnitude), 4.0) << text << " Hz, seed " << seed;
      EXPECT_LT(std::abs(phase), 4.0) << text << " Hz, seed " << seed;
      EXPECT_LT(result.u_rel, 1e-3) << text << " Hz"; // it says something
      // The fits take the harmonics of the exciter for noise: the values are better than they say.
      const double limit = frequency.hz() < 50.0 ? 2e-4 : 3e-5;
      EXPECT_LT(std::abs(std::abs(deviation) - 1.0), limit) << text << " Hz, seed " << seed;
      EXPECT_LT(std::abs(phase) * result.u_rel, limit) << text << " Hz, seed " << seed;
    }
  }
}

// The displacement is ahead by half of what the second signal is late, and nothing else changes.
TEST(Interferometer, TakesTheSecondSignalLaterByItsSkew) {
  const analysis::Frequency frequency = *analysis::Frequency::parse("80");
  std::complex<double> ratios[2];
  double skew_s = 0.0;
  for (int i = 0; i < 2; ++i) {
    BenchSettings of_bench = settings(11);
    of_bench.interferometer->u_skew_s = 1e-7 * i;
    VirtualBench bench(of_bench);
    bench.set_drive({80.0, 0.2, true});
    record(bench, 0.6);
    ratios[i] = evaluate(record(bench, 0.5), frequency).ratio;
    skew_s = truth_of(bench).skew_s;
  }
  ASSERT_GT(std::abs(skew_s), 1e-8);
  const double ahead_rad = frequency.angular() * skew_s / 2.0;
  EXPECT_NEAR(std::arg(ratios[1] / ratios[0]), ahead_rad, 0.02 * std::abs(ahead_rad));
  EXPECT_NEAR(std::abs(ratios[1] / ratios[0]), 1.0, 1e-5);
}

TEST(Interferometer, GivesTheSameSamplesHoweverTimeIsCut) {
  VirtualBench coarse(settings(5));
  VirtualBench fine(settings(5));
  coarse.set_drive({40.0, 0.2, true});
  fine.set_drive({40.0, 0.2, true});
  const Recording a = record(coarse, 0.3, 0.1);
  const Recording b = record(fine, 0.3, 0.00037);
  EXPECT_EQ(a.stamps_ns, b.stamps_ns);
  EXPECT_EQ(a.u1, b.u1);
  EXPECT_EQ(a.u2, b.u2);
  EXPECT_EQ(a.sync, b.sync);
  EXPECT_NEAR(static_cast<double>(a.u1.size()), 150e3, 1.0);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
