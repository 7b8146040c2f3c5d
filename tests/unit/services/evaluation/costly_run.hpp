// A synthetic run of one step whose Monte Carlo checks take tens of seconds: many channels, each
// with an uncertainty just below a power of ten, where the adaptive criterion demands most trials.
// Nobody waits for them: whoever begins such an evaluation abandons it.
#pragma once

#include <string>
#include <vector>

#include "tests/unit/services/evaluation/synthetic_run.hpp"

namespace dyncal::tests {

class CostlyRun {
public:
  explicit CostlyRun(std::string bench = "synthetic") : bench_(std::move(bench)) {}

  [[nodiscard]] wire::Measurement measurement() const {
    wire::Measurement measurement = run_.measurement();
    measurement.bench(bench_);
    measurement.monte_carlo_trials(100'000'000);
    measurement.u_reference_magnitude_rel(1.04e-3); // of 0.95: u is 9.9e-4
    measurement.u_reference_phase_rad(9.9e-4);
    for (std::size_t i = 0; i < channels; ++i) {
      measurement.dut().push_back("dau/" + name(i));
    }
    return measurement;
  }
  [[nodiscard]] wire::SourceDescription acs_description() const {
    wire::SourceDescription description = run_.acs_description();
    description.bench(bench_);
    return description;
  }
  // As many times its first channel, then the others.
  [[nodiscard]] wire::SourceDescription dau_description() const {
    wire::SourceDescription description = run_.dau_description();
    description.bench(bench_);
    auto& described = description.channels();
    const wire::ChannelDescription sensor = described.front();
    described.erase(described.begin());
    for (std::size_t i = channels; i-- > 0;) {
      described.insert(described.begin(), sensor);
      described.front().name(name(i));
    }
    return description;
  }
  [[nodiscard]] std::vector<wire::SampleBlock> acs_blocks() const {
    auto blocks = run_.acs_blocks();
    for (wire::SampleBlock& block : blocks) {
      block.bench(bench_);
    }
    return blocks;
  }
  [[nodiscard]] std::vector<wire::SampleBlock> dau_blocks() const {
    auto blocks = run_.dau_blocks();
    for (wire::SampleBlock& block : blocks) {
      block.bench(bench_);
      block.channel_count(block.channel_count() + channels - 1);
      auto& values = block.values();
      const std::vector<double> sensor(values.begin(), values.begin() + block.sample_count());
      for (std::size_t i = 1; i < channels; ++i) {
        values.insert(values.begin(), sensor.begin(), sensor.end());
      }
    }
    return blocks;
  }

  static constexpr std::uint32_t channels = 20;

private:
  static std::string name(std::size_t channel) { return "acceleration_" + std::to_string(channel); }

  std::string bench_;
  SyntheticRun run_{.steps = {{"40", 10.0}}};
};

} // namespace dyncal::tests
