// A run whose reference is the displacement that a laser interferometer has measured, drawn from a
// seed: a sensor beside it in the same system, at 100 kS/s, with the table's drift and hum and the
// noise of both.
#pragma once

#include <complex>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "drivers/sample_block.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::tests {

struct LaserStep {
  std::string frequency_hz;
  double level_m_s2 = 10.0;
};

struct LaserRun {
  std::uint64_t seed = 1;
  std::vector<LaserStep> steps{{"160"}};
  double drift_m_s = 3e-7;
  double hum_m = 5e-9;                 // at 50.02 Hz
  double table_m_s2_sd = 1e-3;         // of its acceleration, white up to half the rate
  double displacement_noise_m = 2e-11; // of a sample
  double sensor_noise_rel = 1e-4;      // of the level, of a sample
  double level_factor = 1.0;           // over the plan
  double response = 0.03;              // V/(m/s^2)
  double response_rad = -0.2;
  bool is_known = true; // that the displacement is an interferometer's
  // Puts a fault into sample i of a step's displacement and sensor.
  std::function<void(std::size_t i, double& displacement, double& sensor)> fault{};

  [[nodiscard]] evaluation::Recipe recipe() const;
  [[nodiscard]] drivers::SourceDescription description() const;
  [[nodiscard]] std::vector<drivers::SampleBlock> blocks() const;
  [[nodiscard]] std::complex<double> truth() const { return std::polar(response, response_rad); }
};

// In the order of the steps; `change`: of the description, once this part of the blocks has come.
[[nodiscard]] std::vector<evaluation::StepResult>
evaluate(const LaserRun& run, double change_at = 2.0,
         const std::vector<drivers::QuadratureSignals>& change = {});

} // namespace dyncal::tests
