#include "analysis/method/sample_stamping.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;

struct Record {
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> first;
  std::vector<double> second;
};

struct Bench { // a calibration with known answer
  double frequency_hz = 80.0;
  double generator_rel = 0.0; // error of the generator's frequency
  double duration_s = 1.0;
  double acs_rate_hz = 5000.0;
  double acs_clock_rel = 0.4e-6;
  double dau_clock_rel = -0.3e-6;
  double magnitude = 0.95;
  double delay_s = 8.1e-3;
  double reference_amplitude = 10.0;
  double reference_noise = 2e-3;
  double dut_noise = 5e-3;
  double sync_noise = 5e-5;
  double jitter_s = 0.0;
  double adc_lag_rad = 2.94e-4;
  double harmonic_rel = 0.0; // second harmonic of the exciter
  double settling_rel = 0.0; // amplitude still missing at the start, time constant half a second
};

struct Simulation {
  Record acs; // reference, sync
  Record dau; // sensor, sync
};

Simulation simulate(const Bench& bench, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double w = 2.0 * pi * bench.frequency_hz * (1.0 + bench.generator_rel);
  const auto motion = [&](double t) {
    const double rise = 1.0 - bench.settling_rel * std::exp(-t / 0.5);
    return rise * (std::sin(w * t - 0.4) + bench.harmonic_rel * std::sin(2.0 * w * t + 1.0));
  };
  const auto sync = [&](double t) { return std::sin(w * t + 0.3); };
  // Both records begin within one frame of the search, as those of a step do.
  std::uniform_real_distribution<double> anywhere(0.0, 0.1);

  Simulation result;
  const double acs_start = anywhere(random);
  for (int i = 0; i < static_cast<int>(bench.duration_s * bench.acs_rate_hz); ++i) {
    const double t = acs_start + i / bench.acs_rate_hz * (1.0 + bench.acs_clock_rel);
    result.acs.stamps_ns.push_back(std::llround(i / bench.acs_rate_hz * 1e9));
    result.acs.first.push_back(bench.reference_amplitude * motion(t) +
                               bench.reference_noise * normal(random));
    result.acs.second.push_back(sync(t) + 0.01 + 2e-4 * normal(random));
  }
  const double dau_start = anywhere(random);
  const std::int64_t epoch_ns = 1'700'000'003'000'000'000;
  double t = dau_start;
  for (int i = 0; i < static_cast<int>(bench.duration_s / 996.96e-6); ++i) {
    t += 996.96e-6 + 20e-9 * normal(random);
    const double stamp_s =
        (t - dau_start) * (1.0 + bench.dau_clock_rel) + bench.jitter_s * normal(random);
    result.dau.stamps_ns.push_back(epoch_ns + std::llround(stamp_s * 1e9));
    result.dau.first.push_back(bench.reference_amplitude * bench.magnitude *
                                   motion(t - bench.delay_s) +
                               0.3 + bench.dut_noise * normal(random));
    result.dau.second.push_back(1.5 + 0.166245 * sync(t - bench.adc_lag_rad / w) +
                                bench.sync_noise * normal(random));
  }
  return result;
}

SampleStampingInput input_for(const Simulation& simulation, const Bench& bench) {
  SampleStampingInput input{.frequency = Frequency::from_hz(bench.frequency_hz)};
  input.acs_stamps_ns = simulation.acs.stamps_ns;
  input.reference = {"acs/reference", simulation.acs.first};
  input.sync_acs = {"acs/sync", simulation.acs.second};
  input.dau_stamps_ns = simulation.dau.stamps_ns;
  input.sync_dau = {"dau/sync", simulation.dau.second};
  input.dut = {{"dau/acceleration_z", simulation.dau.first}};
  input.adc = {0.166245, bench.adc_lag_rad, 0.0, 0.0};
  input.systematic.dau_jitter_s = bench.jitter_s;
  return input;
}

double true_phase(const Bench& bench) {
  return wrap_phase(-2.0 * pi * bench.frequency_hz * (1.0 + bench.generator_rel) * bench.delay_s);
}

std::size_t coverage_runs() {
  const char* text = std::getenv("DYNCAL_COVERAGE_RUNS");
  return text ? std::stoul(text) : 1000;
}

// k = 2 intervals of a normal distribution cover 95.45 %; the limits are 3 standard deviations of
// the count.
void expect_coverage(const Bench& bench) {
  const std::size_t runs = coverage_runs();
  std::size_t magnitude_covered = 0, phase_covered = 0;
  for (std::size_t run = 0; run < runs; ++run) {
    const Simulation simulation = simulate(bench, static_cast<unsigned>(17 * run + 5));
    const auto result = evaluate_sample_stamping(input_for(simulation, bench));
    ASSERT_TRUE(result.has_value()) << result.error().message;
    const TransferPoint& point = result->points.front();
    if (std::abs(point.magnitude - bench.magnitude) <= 2.0 * point.u_magnitude) {
      ++magnitude_covered;
    }
    if (std::abs(wrap_phase(point.phase_rad - true_phase(bench))) <= 2.0 * point.u_phase_rad) {
      ++phase_covered;
    }
  }
  const double n = static_cast<double>(runs);
  const double margin = 3.0 * std::sqrt(0.0455 * 0.9545 / n);
  EXPECT_NEAR(static_cast<double>(magnitude_covered) / n, 0.9545, margin);
  EXPECT_NEAR(static_cast<double>(phase_covered) / n, 0.9545, margin);
}

std::optional<Record> read_csv(const std::string& path) {
  std::ifstream file(path);
  if (!file) {
    return std::nullopt;
  }
  Record record;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    std::int64_t stamp = 0;
    double first = 0.0, second = 0.0;
    char comma = ',';
    fields >> stamp >> comma >> first >> comma >> second;
    record.stamps_ns.push_back(stamp);
    record.first.push_back(first);
    record.second.push_back(second);
  }
  return record;
}

TEST(SampleStamping, MeetsTheCheckVectorOfTheSyncLink) {
  const auto acs = read_csv(DYNCAL_SHARED_DATA "/vectors/07_sync_link_acs.csv");
  const auto dau = read_csv(DYNCAL_SHARED_DATA "/vectors/07_sync_link_dau.csv");
  if (!acs || !dau) {
    GTEST_SKIP() << "the check vectors are not beside the source tree";
  }
  SampleStampingInput input{.frequency = *Frequency::parse("80")};
  input.frequency_search_rel = 0.0;
  input.acs_stamps_ns = acs->stamps_ns;
  input.reference = {"acs/reference", acs->first};
  input.sync_acs = {"acs/sync", acs->second};
  input.dau_stamps_ns = dau->stamps_ns;
  input.sync_dau = {"dau/sync", dau->second};
  input.dut = {{"dau/dos", dau->first}};
  input.adc = {0.166245, 0.000294, 0.0, 0.0};
  const auto known = evaluate_sample_stamping(input);
  ASSERT_TRUE(known.has_value()) << known.error().message;
  EXPECT_NEAR(known->points[0].magnitude / 0.9500213341130793, 1.0, 1e-12);
  EXPECT_NEAR(known->points[0].phase_rad, 2.211689938320689, 1e-11);
  // Four independent fits: 1.1751875e-5 and 1.1280158e-5 of the DAU, 5.047234e-6 and 5.146075e-6 of
  // the ACS.
  EXPECT_NEAR(known->points[0].u_phase_rad,
              std::sqrt(std::pow(1.1751875732354966e-05, 2) + std::pow(1.1280157924373225e-05, 2) +
                        std::pow(5.04723397488249e-06, 2) + std::pow(5.146075408143012e-06, 2)),
              1e-14);
  EXPECT_NEAR(known->points[0].u_magnitude / known->points[0].magnitude,
              std::hypot(0.00011152923568323966 / 9.500169434572,
                         5.047210648387886e-05 / 9.999953783607571),
              1e-14);

  input.frequency_search_rel = 1e-3;
  const auto refined = evaluate_sample_stamping(input);
  ASSERT_TRUE(refined.has_value()) << refined.error().message;
  EXPECT_NEAR(refined->points[0].magnitude, known->points[0].magnitude, 1e-6);
  EXPECT_NEAR(refined->points[0].phase_rad, known->points[0].phase_rad, 1e-6);
  EXPECT_NEAR(refined->points[0].phase_rad, 2.2116812281272145,
              1e-4); // the truth of the simulation
}

TEST(SampleStamping, CoversTheTruthForWhiteNoise) {
  expect_coverage({});
}

TEST(SampleStamping, CoversTheTruthForStampJitter) {
  expect_coverage(
      {.reference_noise = 1e-4, .dut_noise = 1e-4, .sync_noise = 2e-6, .jitter_s = 2e-6});
}

TEST(SampleStamping, CoversTheTruthWhenTheGeneratorIsOffByAThousandth) {
  expect_coverage({.frequency_hz = 160.0, .generator_rel = 0.9e-3, .acs_clock_rel = 4e-5});
}

// Not white: no exact coverage is promised, but the error stays within what is said.
void expect_within(double limit_u, const Bench& bench) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const Simulation simulation = simulate(bench, seed);
    const auto result = evaluate_sample_stamping(input_for(simulation, bench));
    ASSERT_TRUE(result.has_value());
    const TransferPoint& point = result->points.front();
    EXPECT_LE(std::abs(point.magnitude - bench.magnitude), limit_u * point.u_magnitude) << seed;
    EXPECT_LE(std::abs(wrap_phase(point.phase_rad - true_phase(bench))),
              limit_u * point.u_phase_rad)
        << seed;
  }
}

TEST(SampleStamping, StaysHonestWithHarmonicsOfTheExciter) {
  for (const double f : {10.0, 12.7, 46.7}) {
    expect_within(4.0, {.frequency_hz = f, .dut_noise = 1e-3, .harmonic_rel = 0.01});
  }
}

TEST(SampleStamping, HarmonicsThatAreFoundCostNoUncertainty) {
  const Bench clean{.frequency_hz = 12.7};
  Bench disturbed = clean;
  disturbed.harmonic_rel = 0.01;
  const Simulation plain = simulate(clean, 3), harmonic = simulate(disturbed, 3);
  const auto a = evaluate_sample_stamping(input_for(plain, clean));
  const auto b = evaluate_sample_stamping(input_for(harmonic, disturbed));
  ASSERT_TRUE(a && b);
  EXPECT_NEAR(b->points[0].u_magnitude / a->points[0].u_magnitude, 1.0, 0.1);
  EXPECT_NEAR(b->points[0].u_phase_rad / a->points[0].u_phase_rad, 1.0, 0.1);
  EXPECT_NEAR(b->points[0].magnitude, a->points[0].magnitude, a->points[0].u_magnitude);
}

// The sensor shows the rise 8.1 ms after the reference: no change of the sensor, and no error.
TEST(SampleStamping, StaysHonestWhileTheExciterStillSettles) {
  for (const double settling_rel : {0.003, 0.03}) {
    const Bench bench{.dut_noise = 1e-3, .settling_rel = settling_rel};
    expect_within(4.5, bench); // once in 10^5 claims
    int covered = 0;
    constexpr int runs = 100;
    for (unsigned seed = 101; seed <= 100 + runs; ++seed) {
      const auto result = evaluate_sample_stamping(input_for(simulate(bench, seed), bench));
      ASSERT_TRUE(result.has_value());
      const TransferPoint& point = result->points.front();
      covered += std::abs(point.magnitude - bench.magnitude) <= 2.0 * point.u_magnitude ? 1 : 0;
      covered +=
          std::abs(wrap_phase(point.phase_rad - true_phase(bench))) <= 2.0 * point.u_phase_rad ? 1
                                                                                               : 0;
      EXPECT_FALSE(result->findings.points.front().change) << settling_rel << " " << seed;
    }
    EXPECT_GE(covered, 0.9545 * 2 * runs - 3.0 * std::sqrt(0.0455 * 0.9545 * 2 * runs));
  }
}

TEST(SampleStamping, AChannelThatIsNotExcitedHasNoPhaseAndNoFalseMagnitude) {
  Bench bench{.magnitude = 1e-7};
  const Simulation simulation = simulate(bench, 5);
  SampleStampingInput input = input_for(simulation, bench);
  const std::vector<double> stuck(simulation.dau.first.size(), 17.0);
  input.dut.push_back({"dau/stuck", stuck, 1.0});
  const auto result = evaluate_sample_stamping(input);
  ASSERT_TRUE(result.has_value()) << result.error().message;
  for (const TransferPoint& point : result->points) {
    EXPECT_TRUE(std::isfinite(point.u_magnitude)) << point.channel;
    EXPECT_LE(std::abs(point.magnitude - 1e-7), 4.0 * point.u_magnitude) << point.channel;
    EXPECT_GT(point.u_phase_rad, 0.3) << point.channel;
    EXPECT_LT(point.u_phase_rad, 2.0) << point.channel;
  }
}

TEST(SampleStamping, SystematicPartsAppearOnceEach) {
  const Bench bench;
  const Simulation simulation = simulate(bench, 2);
  SampleStampingInput input = input_for(simulation, bench);
  const auto plain = evaluate_sample_stamping(input);
  input.systematic = {
      .reference_magnitude_rel = 1e-3, .reference_phase_rad = 1.7e-3, .acs_delay_s = 1e-6};
  input.adc.u_phase_lag_rad = 3e-4;
  const auto result = evaluate_sample_stamping(input);
  ASSERT_TRUE(plain && result);
  const double u_plain = plain->points[0].u_phase_rad;
  const double delay = 2.0 * pi * 80.0 * 1e-6;
  EXPECT_NEAR(result->points[0].u_phase_rad,
              std::sqrt(u_plain * u_plain + 1.7e-3 * 1.7e-3 + delay * delay + 9e-8), 1e-10);
  const double rel = plain->points[0].u_magnitude / plain->points[0].magnitude;
  EXPECT_NEAR(result->points[0].u_magnitude / result->points[0].magnitude, std::hypot(rel, 1e-3),
              1e-12);
  EXPECT_EQ(result->points[0].phase_rad, plain->points[0].phase_rad);
}

TEST(SampleStamping, NamesTheSeriesThatHasNoExcitation) {
  const Bench bench;
  Simulation simulation = simulate(bench, 2);
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  for (double& y : simulation.dau.second) {
    y = noise(random);
  }
  const auto result = evaluate_sample_stamping(input_for(simulation, bench));
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::no_excitation);
  EXPECT_NE(result.error().message.find("dau/sync"), std::string::npos);
}

TEST(SampleStamping, RefusesSeriesOfDifferentLength) {
  const Bench bench;
  const Simulation simulation = simulate(bench, 2);
  SampleStampingInput input = input_for(simulation, bench);
  input.dut[0].values = input.dut[0].values.first(10);
  const auto result = evaluate_sample_stamping(input);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::invalid_argument);
}

} // namespace
} // namespace dyncal::analysis
