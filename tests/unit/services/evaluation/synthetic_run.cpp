#include "tests/unit/services/evaluation/synthetic_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace dyncal::tests {
namespace {

constexpr std::int64_t dau_epoch_ns = 1'700'000'000'123'456'789;
constexpr double dau_interval_s = 997e-6;
constexpr double acs_rate_hz = 10'000.0;
constexpr double noise = 1e-3;

wire::ChannelDescription channel(const char* name, const char* unit) {
  wire::ChannelDescription description;
  description.name(name);
  description.unit(unit);
  return description;
}

wire::SourceDescription description(const char* source, wire::SourceKind kind,
                                    const std::vector<wire::ChannelDescription>& channels) {
  wire::SourceDescription message;
  message.bench("synthetic");
  message.source(source);
  message.session(7);
  message.kind(kind);
  message.channels() = channels;
  return message;
}

wire::SampleBlock block_head(const char* source, std::uint64_t number, std::uint64_t first_sample,
                             std::size_t samples, std::uint32_t channels) {
  wire::SampleBlock block;
  block.bench("synthetic");
  block.source(source);
  block.session(7);
  block.block(number);
  block.first_sample(first_sample);
  block.sample_count(static_cast<std::uint32_t>(samples));
  block.channel_count(channels);
  block.interval_denominator(1);
  block.values().resize(samples * channels);
  block.received_utc_ns(1);
  return block;
}

} // namespace

wire::Measurement SyntheticRun::measurement() const {
  wire::Measurement measurement;
  measurement.bench("synthetic");
  measurement.run("r1");
  measurement.method(wire::METHOD_SAMPLE_TIMESTAMPING);
  measurement.reference("acs/reference");
  measurement.sync_acs("acs/sync");
  measurement.sync_dau("dau/sync");
  measurement.u_reference_magnitude_rel(1e-6);
  measurement.u_reference_phase_rad(1e-6);
  measurement.u_adc_delay_s(1e-10);
  measurement.u_acs_delay_s(1e-10);
  std::uint32_t number = 0;
  for (const SyntheticStep& step : steps) {
    wire::PlannedStep planned;
    planned.step(++number);
    planned.repetition(1);
    planned.frequency_text_hz(step.frequency_hz);
    planned.level_m_s2(10.0);
    planned.settling_s(0.2);
    planned.duration_s(0.8);
    measurement.steps().push_back(planned);
  }
  return measurement;
}

wire::SourceDescription SyntheticRun::acs_description() const {
  std::vector channels{channel("reference", R"(\metre\second\tothe{-2})"),
                       channel("sync", R"(\volt)")};
  if (is_in_acs) {
    channels.push_back(channel("sensor", R"(\metre\second\tothe{-2})"));
  }
  return description("acs", wire::SOURCE_ACS, channels);
}

wire::SourceDescription SyntheticRun::dau_description() const {
  wire::SourceDescription dau =
      description("dau", wire::SOURCE_DAU,
                  {channel("acceleration_z", R"(\metre\second\tothe{-2})"),
                   channel("temperature", R"(\degreecelsius)"), channel("sync", R"(\volt)")});
  if (range_is_stated) {
    dau.channels()[0].minimum(-sensor_range);
    dau.channels()[0].maximum(sensor_range);
  }
  return dau;
}

double SyntheticRun::duration_s() const {
  return off_s + static_cast<double>(steps.size()) * (on_s + off_s);
}

double SyntheticRun::excitation(double t_s, double& phase_turns) const {
  const double period = on_s + off_s;
  const double in_list = t_s - off_s;
  const auto index = static_cast<std::ptrdiff_t>(std::floor(in_list / period));
  if (index < 0 || index >= static_cast<std::ptrdiff_t>(steps.size()) ||
      in_list - static_cast<double>(index) * period > on_s) {
    return 0.0;
  }
  const SyntheticStep& step = steps[static_cast<std::size_t>(index)];
  phase_turns = std::stod(step.frequency_hz) * t_s;
  const double on_for_s = in_list - static_cast<double>(index) * period;
  return settling_time_constant_s > 0.0
             ? step.amplitude * (1.0 - 0.1 * std::exp(-on_for_s / settling_time_constant_s))
             : step.amplitude;
}

double SyntheticRun::signal(double t_s, double gain, double delay) const {
  double phase_turns = 0.0;
  const double amplitude = excitation(t_s, phase_turns);
  const double turns = t_s == 0.0 ? 0.0
                                  : phase_turns * (t_s - delay) /
                                        t_s; // steady from its first instant: nothing to settle
  return amplitude * gain * std::sin(2.0 * std::numbers::pi * turns);
}

std::vector<wire::SampleBlock> SyntheticRun::acs_blocks() const {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0.0, noise);
  const std::size_t samples = block_samples * 10;
  const auto total = static_cast<std::uint64_t>(duration_s() * acs_rate_hz);
  std::vector<wire::SampleBlock> blocks;
  for (std::uint64_t first = 0; first < total; first += samples) {
    const std::size_t count = std::min<std::size_t>(samples, total - first);
    wire::SampleBlock block = block_head("acs", blocks.size(), first, count, is_in_acs ? 3 : 2);
    block.interval_numerator_ns(100'000);
    for (std::size_t i = 0; i < count; ++i) {
      const double t = static_cast<double>(first + i) / acs_rate_hz;
      block.values()[i] = signal(t, 1.0, 0.0) + 10.0 * normal(random);
      block.values()[count + i] = signal(t, 0.1, 0.0) + normal(random);
      if (is_in_acs) {
        block.values()[2 * count + i] = signal(t, magnitude, delay_s) + 10.0 * normal(random);
      }
    }
    blocks.push_back(block);
  }
  blocks.back().end_of_stream(true);
  return blocks;
}

std::vector<wire::SampleBlock> SyntheticRun::dau_blocks() const {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(0.0, noise);
  const auto total = static_cast<std::uint64_t>(duration_s() / dau_interval_s);
  std::vector<wire::SampleBlock> blocks;
  std::uint64_t number = 0;
  for (std::uint64_t first = 0; first < total; first += block_samples, ++number) {
    const std::size_t count = std::min<std::size_t>(block_samples, total - first);
    wire::SampleBlock block = block_head("dau", number, first + 1, count, 3);
    for (std::size_t i = 0; i < count; ++i) {
      const auto t_ns = static_cast<std::int64_t>(
          std::llround(static_cast<double>(first + i) * dau_interval_s * 1e9));
      const double t = static_cast<double>(t_ns) * 1e-9;
      block.stamps_ns().push_back(dau_epoch_ns + t_ns);
      block.values()[i] = signal(t, magnitude, delay_s) + 10.0 * normal(random) +
                          sensor_hum * std::sin(2.0 * std::numbers::pi * 50.0 * t + 0.4);
      if (sensor_range > 0.0) {
        block.values()[i] = std::clamp(block.values()[i], -sensor_range, sensor_range);
      }
      block.values()[count + i] = 25.0;
      block.values()[2 * count + i] = signal(t, 0.0166, 0.0) + 1.5 + 1e-4 * normal(random);
    }
    if (number != lost_block || lost_block == 0) {
      blocks.push_back(block);
    }
  }
  blocks.back().end_of_stream(true);
  return blocks;
}

} // namespace dyncal::tests
