#include "tests/unit/services/evaluation/laser_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "services/contract/source_block.hpp"
#include "services/evaluation/run_evaluator.hpp"

namespace dyncal::tests {
namespace {

constexpr double rate_hz = 100'000.0;
constexpr double pause_s = 0.4;
constexpr double settling_s = 0.2;
constexpr double duration_s = 0.8;
constexpr double excited_s = 1.2;
constexpr std::size_t block_samples = 5000;
constexpr double turn = 2.0 * std::numbers::pi;

drivers::ChannelDescription channel(const char* name, const char* unit) {
  return {.name = name, .quantity = "", .unit = unit};
}

std::size_t samples_in(double seconds) {
  return static_cast<std::size_t>(std::llround(seconds * rate_hz));
}

} // namespace

evaluation::Recipe LaserRun::recipe() const {
  evaluation::Recipe recipe;
  recipe.bench = "laser";
  recipe.run = "r1";
  recipe.roles.method = contract::EvaluationMethod::analogue;
  recipe.roles.reference = {"acs", "displacement"};
  recipe.roles.sync_acs = {"acs", "sync"};
  recipe.roles.dut = {{"acs", "sensor"}};
  recipe.systematic.reference_magnitude_rel = 1e-6;
  recipe.systematic.reference_phase_rad = 1e-6;
  recipe.systematic.acs_delay_s = 1e-10;
  std::uint32_t number = 0;
  for (const LaserStep& step : steps) {
    recipe.steps.push_back({.step = ++number,
                            .repetition = 1,
                            .frequency_text_hz = step.frequency_hz,
                            .frequency = *analysis::Frequency::parse(step.frequency_hz),
                            .level_m_s2 = step.level_m_s2,
                            .settling_s = settling_s,
                            .duration_s = duration_s});
  }
  return recipe;
}

drivers::SourceDescription LaserRun::description() const {
  drivers::SourceDescription description;
  description.device = "interferometer";
  description.channels = {channel("sync", R"(\volt)"), channel("sensor", R"(\volt)"),
                          channel("displacement", R"(\metre)")};
  description.nominal_rate_hz = rate_hz;
  if (is_known) {
    drivers::QuadratureSignals signals;
    signals.channel = "displacement";
    signals.displacement_per_turn_m = 316.4e-9;
    signals.u_wavelength_rel = 2e-6;
    signals.radius_u1 = 0.64;
    signals.u_ellipse_rad = {2e-4, 1e-4};
    signals.periodic_error_rad = {0.0, 0.0, 1e-4, 1e-4};
    signals.detector_bandwidth_hz = 5e6;
    signals.u_skew_s = 1e-9;
    description.quadrature_signals = {signals};
  }
  return description;
}

std::vector<drivers::SampleBlock> LaserRun::blocks() const {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> phase(-3.0, 3.0);
  std::vector<double> sync, sensor, displacement;
  double table_m = 0.0;
  double table_m_s = 0.0;
  const auto add = [&](double acceleration, double shown, double angular, double sync_volt,
                       double level) {
    const double t = static_cast<double>(sync.size()) / rate_hz;
    const double of_table = table_m_s2_sd * normal(random);
    table_m_s += of_table / rate_hz;
    table_m += table_m_s / rate_hz;
    sync.push_back(sync_volt + 1e-4 * normal(random));
    sensor.push_back(shown + response * level * sensor_noise_rel * normal(random));
    displacement.push_back((angular > 0.0 ? -acceleration / (angular * angular) : 0.0) +
                           drift_m_s * t + hum_m * std::sin(turn * 50.02 * t) + table_m +
                           displacement_noise_m * normal(random));
  };
  const auto pause = [&](double level) {
    for (std::size_t i = 0; i < samples_in(pause_s); ++i) {
      add(0.0, 0.0, 0.0, 0.0, level);
    }
  };
  for (const LaserStep& step : steps) {
    pause(step.level_m_s2);
    const double angular = turn * std::stod(step.frequency_hz);
    const double of_motion = phase(random);
    const double of_sync = phase(random);
    const double level = level_factor * step.level_m_s2;
    for (std::size_t i = 0; i < samples_in(excited_s); ++i) {
      const double angle = angular * static_cast<double>(i) / rate_hz;
      add(level * std::sin(angle + of_motion),
          level * response * std::sin(angle + of_motion + response_rad), angular,
          std::sin(angle + of_sync), step.level_m_s2);
      if (fault) {
        fault(i, displacement.back(), sensor.back());
      }
    }
  }
  pause(steps.back().level_m_s2);
  std::vector<drivers::SampleBlock> blocks;
  for (std::size_t first = 0; first < sync.size(); first += block_samples) {
    drivers::SampleBlock& block = blocks.emplace_back();
    block.first_sample = first;
    block.samples = std::min(block_samples, sync.size() - first);
    block.clock = drivers::RegularClock{0, 1'000'000'000, static_cast<std::int64_t>(rate_hz)};
    for (const auto* column : {&sync, &sensor, &displacement}) {
      const auto begin = column->begin() + static_cast<std::ptrdiff_t>(first);
      block.values.insert(block.values.end(), begin,
                          begin + static_cast<std::ptrdiff_t>(block.samples));
    }
  }
  return blocks;
}

std::vector<evaluation::StepResult>
evaluate(const LaserRun& run, double change_at,
         const std::vector<drivers::QuadratureSignals>& change) {
  evaluation::RunEvaluator evaluator(run.recipe());
  const auto described = evaluator.describe("acs", run.description());
  EXPECT_TRUE(described) << described.error().message;
  const std::vector<drivers::SampleBlock> blocks = run.blocks();
  std::map<std::uint32_t, evaluation::StepResult> results;
  const auto collect = [&] {
    evaluation::EvaluationOutput output = evaluator.take_output();
    for (auto* some : {&output.results, &output.settled}) {
      for (evaluation::StepResult& result : *some) {
        results.insert_or_assign(result.step, std::move(result));
      }
    }
  };
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (static_cast<double>(i) >= change_at * static_cast<double>(blocks.size())) {
      evaluator.describe_signals("acs", change);
    }
    contract::SourceBlock block = contract::view_block(blocks[i], 1, i + 1);
    block.channels = 3;
    evaluator.add("acs", block);
    collect();
  }
  evaluator.end_of_excitation(false);
  evaluator.finish_now();
  collect();
  std::vector<evaluation::StepResult> in_order;
  for (auto& [step, result] : results) {
    in_order.push_back(std::move(result));
  }
  return in_order;
}

} // namespace dyncal::tests
