// A run made by formula: an ACS and a DAU in unrelated clocks that record the same sine steps, with
// a sensor of known magnitude and delay.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "idl/dyncal.h"

namespace dyncal::tests {

struct SyntheticStep {
  std::string frequency_hz;
  double amplitude = 10.0; // 0: nothing is excited
};

struct SyntheticRun {
  std::vector<SyntheticStep> steps{{"40", 10.0}, {"80", 10.0}};
  double magnitude = 0.95;
  double delay_s = 1.5e-3;
  double on_s = 1.5;
  double off_s = 0.5;
  double settling_time_constant_s = 0.0; // the amplitude comes up from nine tenths; 0: at once
  std::size_t block_samples = 50;        // of the DAU; ten times as many of the ACS
  double sensor_range = 0.0;             // the sensor's end stops, plus and minus; 0: none
  bool range_is_stated = true;           // in its description
  double sensor_hum = 0.0;               // at 50 Hz, all the time
  std::size_t lost_block = 0;            // number of a DAU block that does not arrive; 0: none
  bool is_in_acs = false;                // the ACS records the sensor as well, as acs/sensor

  [[nodiscard]] wire::Measurement measurement() const;
  [[nodiscard]] wire::SourceDescription acs_description() const;
  [[nodiscard]] wire::SourceDescription dau_description() const;
  [[nodiscard]] std::vector<wire::SampleBlock> acs_blocks() const;
  [[nodiscard]] std::vector<wire::SampleBlock> dau_blocks() const;

private:
  [[nodiscard]] double excitation(double t_s, double& phase_turns) const;
  [[nodiscard]] double signal(double t_s, double gain, double delay) const;
  [[nodiscard]] double duration_s() const;
};

} // namespace dyncal::tests
