// A device that records the two signals of a laser interferometer and sync, for tests: what the
// mirror does is known, faults are put in where a test wants them.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "analysis/interferometer/ellipse.hpp"
#include "drivers/sample_source.hpp"

namespace dyncal::tests {

struct MirrorMotion {
  double frequency_hz = 160.0;
  double displacement_m = 1e-6; // amplitude
  double drift_m_s = 1e-7;
  double hum_m = 0.0; // at 50.02 Hz

  [[nodiscard]] double at(double t) const {
    constexpr double turn = 2.0 * std::numbers::pi;
    return displacement_m * std::sin(turn * frequency_hz * t + 0.4) + drift_m_s * t +
           hum_m * std::sin(turn * 50.02 * t);
  }
};

struct DeviceSettings {
  double rate_hz = 500e3;
  double seconds = 0.5;
  double noise_rel = 2e-3; // of the radius
  double range_v = 1.0;
  double wavelength_m = 632.8211e-9;
  analysis::Ellipse ellipse{0.02, -0.015, 1.05, 0.0873, 0.64};
  MirrorMotion motion{};
  std::uint64_t seed = 1;
};

inline std::vector<double> column_of(const drivers::SampleBlock& block, std::size_t i) {
  const auto begin = block.values.begin() + static_cast<std::ptrdiff_t>(i * block.samples);
  return {begin, begin + static_cast<std::ptrdiff_t>(block.samples)};
}

// All samples in one block: u1, u2, sync, in counts of 14 bits.
inline drivers::SampleBlock record_of(const DeviceSettings& settings) {
  std::mt19937_64 random(settings.seed);
  std::normal_distribution<double> normal;
  const auto n = static_cast<std::size_t>(settings.rate_hz * settings.seconds);
  const analysis::Ellipse& e = settings.ellipse;
  const double step = 2.0 * settings.range_v / 16384.0;
  drivers::SampleBlock block;
  block.samples = n;
  block.clock = drivers::RegularClock{1000, 1'000'000'000,
                                      static_cast<std::int64_t>(std::llround(settings.rate_hz))};
  block.values.resize(3 * n);
  const auto count = [&](double volt) { return step * std::round(volt / step); };
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / settings.rate_hz;
    const double phi = 4.0 * std::numbers::pi * settings.motion.at(t) / settings.wavelength_m + 0.3;
    const double noise = settings.noise_rel * e.radius;
    block.values[i] = count(e.p + e.radius * std::cos(phi) + noise * normal(random));
    block.values[n + i] =
        count(e.q + e.radius / e.r * std::sin(phi - e.alpha_rad) + noise * normal(random));
    block.values[2 * n + i] =
        std::sin(2.0 * std::numbers::pi * settings.motion.frequency_hz * t + 0.9);
  }
  return block;
}

inline drivers::SourceDescription description_of(const DeviceSettings& settings) {
  drivers::SourceDescription description;
  description.device = "digitiser";
  description.driver = "test";
  const double step = 2.0 * settings.range_v / 16384.0;
  for (const char* name : {"u1", "u2", "sync"}) {
    description.channels.push_back({.name = name,
                                    .quantity = "Voltage",
                                    .unit = R"(\volt)",
                                    .minimum = -settings.range_v,
                                    .maximum = settings.range_v,
                                    .resolution = name[0] == 'u' ? step : 0.0});
  }
  description.nominal_rate_hz = settings.rate_hz;
  return description;
}

// Part of a record, as a block of its own.
inline drivers::SampleBlock part_of(const drivers::SampleBlock& record, std::size_t first,
                                    std::size_t samples) {
  drivers::SampleBlock block;
  block.first_sample = record.first_sample + first;
  block.samples = samples;
  block.clock = record.clock;
  for (std::size_t column = 0; column * record.samples < record.values.size(); ++column) {
    const auto begin =
        record.values.begin() + static_cast<std::ptrdiff_t>(column * record.samples + first);
    block.values.insert(block.values.end(), begin, begin + static_cast<std::ptrdiff_t>(samples));
  }
  return block;
}

class SimulatedDevice : public drivers::SampleSource {
public:
  using Sessions = std::vector<std::vector<drivers::SampleBlock>>;
  SimulatedDevice(drivers::SourceDescription description, Sessions sessions)
      : description_(std::move(description)), sessions_(std::move(sessions)) {}

  drivers::Expected<drivers::SourceDescription> describe() override { return description_; }
  drivers::Expected<void> run(drivers::SampleSink& sink) override {
    for (auto& blocks : sessions_) {
      sink.begin_session();
      sink.describe(description_);
      for (drivers::SampleBlock& block : blocks) {
        sink.take(std::move(block));
      }
      sink.count({});
    }
    return {};
  }
  void stop() override {}

private:
  drivers::SourceDescription description_;
  Sessions sessions_;
};

// A record in blocks of drawn lengths.
inline std::vector<drivers::SampleBlock> cut(const drivers::SampleBlock& record,
                                             std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::size_t> length(1, 20'000);
  std::vector<drivers::SampleBlock> blocks;
  for (std::size_t first = 0; first < record.samples;) {
    const std::size_t n = std::min(length(random), record.samples - first);
    blocks.push_back(part_of(record, first, n));
    first += n;
  }
  return blocks;
}

} // namespace dyncal::tests
