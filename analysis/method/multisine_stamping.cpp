#include "analysis/method/multisine_stamping.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "analysis/method/analogue_comparison.hpp"
#include "analysis/method/motion_channel.hpp"
#include "analysis/method/neighbour_noise.hpp"
#include "analysis/sine/line_products.hpp"
#include "analysis/step/compound_integrity.hpp"

namespace dyncal::analysis {
namespace {

constexpr double dithered = 2.0; // steps of a converter in the rms of what is left of a signal

Error of_channel(const std::string& channel, const Error& error) {
  return {error.code, channel + ": " + error.message};
}

std::vector<Frequency> frequencies_of(const std::vector<ExcitedLine>& lines) {
  std::vector<Frequency> frequencies;
  std::ranges::transform(lines, std::back_inserter(frequencies), &ExcitedLine::frequency);
  return frequencies;
}

// The channels of one clock, sync first, in waveform time.
struct SystemOfLines {
  WaveformClock clock;
  std::vector<std::int64_t> times_ns;
  std::vector<ChannelSamples> channels;
  std::vector<SeparatedLines> lines; // one: of all channels
  std::vector<SignalIntegrity> integrity;
  std::vector<double> noise_parts; // of what the lines leave (line_products.hpp)

  [[nodiscard]] const SeparatedLines& separated() const { return lines.front(); }
  [[nodiscard]] double u_scatter_s() const {
    return clock.scatter_s / std::sqrt(static_cast<double>(clock.blocks));
  }
};

// What only the whole signal of a channel shows.
void look_at_whole_signal(std::span<const Frequency> lines, double period_s, std::size_t channel,
                          SystemOfLines& system) {
  SignalIntegrity& integrity = system.integrity.emplace_back();
  const ChannelSamples& samples = system.channels[channel];
  integrity.samples = samples.values.size();
  measure_compound_integrity(samples.values, system.separated().rest(channel), samples.expected,
                             integrity);
  const LineProducts products =
      measure_line_products(lines, period_s, system.separated(), channel, system.times_ns);
  integrity.thd = products.distortion;
  integrity.u_thd = products.u_distortion;
  system.noise_parts.push_back(products.noise_part);
}

Expected<SystemOfLines> fit_system(const MultisineStampingInput& input,
                                   std::span<const std::int64_t> stamps_ns,
                                   std::vector<ChannelSamples> channels) {
  const std::vector<Frequency> lines = frequencies_of(input.lines);
  const std::string name = channels.front().name;
  SystemOfLines system;
  auto clock =
      find_waveform_clock(lines, input.frequency_search_rel, stamps_ns, channels.front().values);
  if (!clock) {
    return fail(of_channel(name, clock.error()));
  }
  system.clock = std::move(*clock);
  system.times_ns = system.clock.in_waveform_time(stamps_ns);
  std::vector<std::span<const double>> values;
  std::ranges::transform(channels, std::back_inserter(values), &ChannelSamples::values);
  auto separated = SeparatedLines::make(lines, system.times_ns, values);
  if (!separated) {
    return fail(of_channel(name + " and the channels recorded with it", separated.error()));
  }
  system.lines.push_back(std::move(*separated));
  system.channels = std::move(channels);
  for (std::size_t channel = 0; channel < system.channels.size(); ++channel) {
    look_at_whole_signal(lines, input.period_s, channel, system);
  }
  return system;
}

// What the errors of the converter do to tau, times w: all the same way round in the worst case.
double u_lag_s(const std::vector<ExcitedLine>& lines, const WaveformLink& link) {
  double errors = 0.0;
  double weights = 0.0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (link.lines[k].u_rad > 0.0) {
      const double weight = 1.0 / (link.lines[k].u_rad * link.lines[k].u_rad);
      const double w = lines[k].frequency.angular();
      errors += weight * w * lines[k].adc.u_phase_lag_rad;
      weights += weight * w * w;
    }
  }
  return errors / weights;
}

struct LinkedSystems {
  const SystemOfLines& acs;
  const SystemOfLines& dau;
  std::vector<std::int64_t> dau_on_acs_ns; // its times on the scale of the ACS
  double u_offset_s = 0.0;
  double u_lag_s = 0.0;
};

// Of one line, without the others. `values` holds its samples.
ChannelSamples line_of(const SystemOfLines& system, std::size_t channel, std::size_t line,
                       std::vector<double>& values) {
  values = system.separated().only(line, channel);
  ChannelSamples samples = system.channels[channel];
  samples.values = values;
  samples.rise = {};
  // The other lines carry it over the steps of its converter, whose error is noise then.
  const double lines_rms = std::sqrt(0.5) * std::abs(system.separated().at(line, channel).phasor);
  const bool alone =
      lines_rms + system.separated().residual_sd(channel) < dithered * samples.resolution;
  samples.resolution = alone ? samples.resolution : 0.0;
  samples.expected = {};
  return samples;
}

// Ends, runs and distortion of the whole signal in place of those of the line.
void take_whole_signal(const SignalIntegrity& whole, ChannelFit& fit) {
  if (!fit.integrity) {
    return;
  }
  SignalIntegrity& of_line = *fit.integrity;
  of_line.at_range_part = whole.at_range_part;
  of_line.clipped_part = whole.clipped_part;
  of_line.clipping_rel = whole.clipping_rel;
  of_line.longest_run = whole.longest_run;
  of_line.longest_stuck = whole.longest_stuck;
  of_line.stuck_part = whole.stuck_part;
  of_line.repeats = 0;
  of_line.longest_repeat = 0;
  of_line.thd = whole.thd;
  of_line.u_thd = whole.u_thd;
}

// As its own source shows it: at the frequency and about the instant that its clock has.
void return_to_own_clock(const WaveformClock& clock, std::int64_t shift_ns, ChannelFit& fit) {
  fit.phase_origin_ns -= shift_ns;
  fit.u_frequency_hz = fit.frequency.hz() * clock.u_rate_rel();
  fit.frequency = fit.frequency.shifted_by_hz(fit.frequency.hz() * clock.rate_rel());
}

// Of sync, which the link has used.
Expected<ChannelFit> fit_of_sync(const SystemOfLines& system, const Frequency& frequency,
                                 std::size_t line) {
  std::vector<double> values = system.separated().only(line, 0);
  const std::span<const double> channel = values;
  const std::int64_t origin_ns = system.separated().origin_ns();
  auto fits = fit_sine(frequency, origin_ns, system.times_ns, std::span(&channel, 1));
  if (!fits) {
    return fail(of_channel(system.channels.front().name, fits.error()));
  }
  ChannelFit fit{system.channels.front().name, frequency, 0.0, origin_ns, fits->front(), {}, {}};
  fit.integrity = system.integrity.front();
  fit.integrity->amplitude = fit.fit.amplitude();
  fit.integrity->residual_sd = fit.fit.residual_sd();
  return_to_own_clock(system.clock, 0, fit);
  return fit;
}

AbsoluteTimeInput comparison_of(const MultisineStampingInput& input, const LinkedSystems& systems,
                                std::size_t line) {
  const SystematicUncertainty& systematic = input.systematic;
  AbsoluteTimeInput one{.frequency = input.lines[line].frequency};
  one.frequency_search_rel = 0.0;
  one.reference_stamps_ns = systems.acs.times_ns;
  one.dut_stamps_ns = systems.dau_on_acs_ns;
  one.channel_delay_s = -input.reference_delay_s;
  one.reference_response = input.lines[line].reference_response;
  one.systematic = {.reference_magnitude_rel = systematic.reference_magnitude_rel,
                    .reference_phase_rad = systematic.reference_phase_rad,
                    .channel_delay_s = systematic.acs_delay_s,
                    .clock_offset_s = systems.u_offset_s,
                    .stamp_jitter_s = systematic.dau_jitter_s,
                    .reference_tick_s = 0.0,
                    .dut_tick_s = systematic.dau_tick_s};
  return one;
}

// A fit takes all that it leaves for noise; what the lines make of each other falls on none of
// them.
void take_products_from_noise(const std::string& subject, double noise_part, TransferPoint& point) {
  for (Contribution& row : point.budget) {
    if (row.kind != ContributionKind::fit_noise || row.subject != subject) {
      continue;
    }
    const double less = 1.0 - noise_part * noise_part;
    const auto without = [&](double u, double of_row) {
      return std::sqrt(std::max(0.0, u * u - less * of_row * of_row));
    };
    point.u_magnitude = without(point.u_magnitude, row.u_magnitude_rel * point.magnitude);
    point.u_phase_rad = without(point.u_phase_rad, row.u_phase_rad);
    row.u_magnitude_rel *= noise_part;
    row.u_phase_rad *= noise_part;
  }
}

// Of what is drawn from the samples.
double stated_noise_rel(const TransferPoint& point) {
  double squares = 0.0;
  for (const Contribution& row : point.budget) {
    if (row.kind == ContributionKind::fit_noise || row.kind == ContributionKind::structure) {
      squares += row.u_magnitude_rel * row.u_magnitude_rel;
    }
  }
  return std::sqrt(squares);
}

LineOfChannel line_and_rest(const SystemOfLines& system, std::size_t channel, std::size_t line,
                            std::int64_t shift_ns = 0) {
  const SeparatedLines& lines = system.separated();
  return {lines.at(line, channel).phasor, lines.rest(channel), system.times_ns, lines.origin_ns(),
          shift_ns};
}

void add_neighbour_row(const MultisineStampingInput& input, const LinkedSystems& systems,
                       std::size_t line, std::size_t channel, TransferPoint& point) {
  LineOfChannel reference = line_and_rest(systems.acs, 1, line);
  std::vector<double> still; // without the motion of the table, which a displacement is full of
  if (is_differentiated(systems.acs.channels[1])) {
    still =
        without_slow_motion(input.lines[line].frequency.hz(), reference.times_ns, reference.rest);
    reference.rest = still;
  }
  const double u_rel = neighbour_noise_beyond(
      stated_noise_rel(point), frequencies_of(input.lines), line, input.period_s, reference,
      line_and_rest(systems.dau, channel, line,
                    systems.dau_on_acs_ns.front() - systems.dau.times_ns.front()));
  if (u_rel > 0.0) {
    point.budget.push_back({.kind = ContributionKind::structure,
                            .subject = "the lines beside the excitation",
                            .u_magnitude_rel = u_rel,
                            .u_phase_rad = u_rel});
    point.u_magnitude = std::hypot(point.u_magnitude, u_rel * point.magnitude);
    point.u_phase_rad = std::hypot(point.u_phase_rad, u_rel);
  }
}

void add_lag_row(double u_phase_rad, TransferPoint& point) {
  if (u_phase_rad > 0.0) {
    point.budget.push_back({.kind = ContributionKind::adc_phase, .u_phase_rad = u_phase_rad});
    point.u_phase_rad = std::hypot(point.u_phase_rad, u_phase_rad);
  }
}

Expected<EvaluatedLine> evaluate_line(const MultisineStampingInput& input,
                                      const LinkedSystems& systems, std::size_t line) {
  const Frequency& frequency = input.lines[line].frequency;
  AbsoluteTimeInput one = comparison_of(input, systems, line);
  std::vector<double> reference;
  std::vector<std::vector<double>> sensors(input.dut.size());
  one.reference = line_of(systems.acs, 1, line, reference);
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    one.dut.push_back(line_of(systems.dau, i + 1, line, sensors[i]));
  }
  DYNCAL_TRY(auto compared, evaluate_absolute_time(one));
  DYNCAL_TRY(auto sync_acs, fit_of_sync(systems.acs, frequency, line));
  DYNCAL_TRY(auto sync_dau, fit_of_sync(systems.dau, frequency, line));
  EvaluatedLine evaluated{std::move(compared.reference), std::move(sync_acs), std::move(sync_dau),
                          std::move(compared.points), std::move(compared.findings)};
  take_whole_signal(systems.acs.integrity[1], evaluated.reference);
  return_to_own_clock(systems.acs.clock, 0, evaluated.reference);
  const std::int64_t shift_ns = systems.dau_on_acs_ns.front() - systems.dau.times_ns.front();
  for (std::size_t i = 0; i < evaluated.points.size(); ++i) {
    TransferPoint& point = evaluated.points[i];
    take_whole_signal(systems.dau.integrity[i + 1], point.dut);
    return_to_own_clock(systems.dau.clock, shift_ns, point.dut);
    take_products_from_noise("the sensor", systems.dau.noise_parts[i + 1], point);
    if (!is_differentiated(systems.acs.channels[1])) { // whose noise is not that of its samples
      take_products_from_noise("the reference", systems.acs.noise_parts[1], point);
    }
    add_neighbour_row(input, systems, line, i + 1, point);
    add_lag_row(frequency.angular() * systems.u_lag_s, point);
  }
  return evaluated;
}

void keep_rests(const SystemOfLines& acs, const SystemOfLines& dau,
                std::vector<std::vector<double>>& rests) {
  const auto keep = [&](const SystemOfLines& system, std::size_t channel) {
    const auto rest = system.separated().rest(channel);
    rests.emplace_back(rest.begin(), rest.end());
  };
  keep(acs, 1);
  keep(acs, 0);
  for (std::size_t channel = 0; channel < dau.channels.size(); ++channel) {
    keep(dau, channel);
  }
}

std::vector<ChannelSamples> with_sync(const ChannelSamples& sync,
                                      std::span<const ChannelSamples> others) {
  std::vector<ChannelSamples> all{sync};
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

} // namespace

Expected<MultisineStampingResult> evaluate_multisine_stamping(const MultisineStampingInput& input) {
  DYNCAL_TRY(const auto acs, fit_system(input, input.acs_stamps_ns,
                                        with_sync(input.sync_acs, std::span(&input.reference, 1))));
  DYNCAL_TRY(const auto dau,
             fit_system(input, input.dau_stamps_ns, with_sync(input.sync_dau, input.dut)));
  std::vector<double> lag_rad;
  for (const ExcitedLine& line : input.lines) {
    lag_rad.push_back(line.adc.phase_lag_rad);
  }
  DYNCAL_TRY(auto link, link_waveforms(frequencies_of(input.lines), input.period_s, acs.separated(),
                                       dau.separated(), lag_rad));
  const std::int64_t shift_ns =
      acs.separated().origin_ns() - dau.separated().origin_ns() + std::llround(1e9 * link.offset_s);
  LinkedSystems systems{acs, dau, dau.times_ns, 0.0, u_lag_s(input.lines, link)};
  for (std::int64_t& time : systems.dau_on_acs_ns) {
    time += shift_ns;
  }
  systems.u_offset_s = std::max(link.u_offset_s, std::hypot(acs.u_scatter_s(), dau.u_scatter_s()));
  MultisineStampingResult result{{}, acs.clock, dau.clock, std::move(link), {}};
  keep_rests(acs, dau, result.rests);
  for (std::size_t line = 0; line < input.lines.size(); ++line) {
    result.lines.push_back(evaluate_line(input, systems, line));
  }
  return result;
}

} // namespace dyncal::analysis
