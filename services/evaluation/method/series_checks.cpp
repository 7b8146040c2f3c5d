#include "services/evaluation/method/series_checks.hpp"

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "analysis/method/trigger_phase.hpp"
#include "analysis/sine/equidistant_axis.hpp"
#include "analysis/uncertainty/found_resolution.hpp"
#include "services/evaluation/method/line_check.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double ppm = 1e6;
constexpr double whole_period = 1.0; // of sync in a trace: less does not show both of its ends

std::vector<std::int64_t> series_stamps_ns(const CheckedShots& checked) {
  const double real_rate_hz = checked.evaluated.rate.real_rate_hz;
  std::vector<std::int64_t> stamps_ns(checked.shots.front().series->samples);
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    stamps_ns[i] = std::llround(static_cast<double>(i) * 1e9 / real_rate_hz);
  }
  return stamps_ns;
}

analysis::SignalExpectation expected_of(const drivers::ChannelDescription& description,
                                        std::span<const double> values) {
  analysis::SignalExpectation expected = expectation_of(description);
  if (!(expected.resolution > 0.0)) {
    expected.resolution = analysis::found_resolution(values);
  }
  return expected;
}

template <class CheckOf>
SignalCheck first_finding(const std::vector<ShotRecord::Shot>& shots, CheckOf check_of) {
  std::optional<SignalCheck> first;
  for (const ShotRecord::Shot& shot : shots) {
    SignalCheck check = check_of(shot);
    if (!check.flags.empty()) {
      return check;
    }
    if (!first) {
      first = std::move(check);
    }
  }
  return *first;
}

SignalCheck check_trace(const TriggeredRecord& trace, std::span<const double> values,
                        const analysis::Frequency& frequency,
                        const drivers::ChannelDescription& description, const std::string& name) {
  const analysis::EquidistantAxis axis(trace.interval_s);
  SignalCheck check = check_signal(
      name, analysis::measure_integrity(axis.on_axis(frequency.hz()), axis.stamps_ns(values.size()),
                                        values, expected_of(description, values)));
  check.refusal.clear();
  if (check.flags.empty() && analysis::periods_of({trace.first_sample_s, trace.interval_s, values},
                                                  frequency.hz()) < whole_period) {
    check.flags.push_back(
        flag_of_channel(ResultFlag::signal_not_judged, name, "its trace is shorter than a period"));
  }
  return check;
}

} // namespace

SignalCheck check_series(const CheckedShots& checked, const ChannelName& channel,
                         std::size_t column, std::vector<analysis::SineShape>& shapes) {
  const std::vector<std::int64_t> stamps_ns = series_stamps_ns(checked);
  const drivers::ChannelDescription& description = checked.sensor.description().channels[column];
  return first_finding(checked.shots, [&](const ShotRecord::Shot& shot) {
    const std::span<const double> values = shot.series->channel(column);
    const auto integrity = analysis::measure_integrity(checked.task.step().frequency, stamps_ns,
                                                       values, expected_of(description, values));
    if (integrity) {
      shapes.push_back(integrity->shape);
    }
    return check_signal(channel.text(), integrity);
  });
}

SignalCheck check_traces(const CheckedShots& checked, const ChannelName& sync) {
  const std::size_t column = *checked.oscilloscope.channel(sync.channel);
  const drivers::ChannelDescription& description =
      checked.oscilloscope.description().channels[column];
  return first_finding(checked.shots, [&](const ShotRecord::Shot& shot) {
    return check_trace(*shot.trace, shot.trace->channel(column),
                       checked.evaluated.sync_acs.frequency, description, sync.text());
  });
}

ChannelLines lines_of_series(const CheckedShots& checked, const ChannelName& channel,
                             std::size_t column) {
  const std::vector<std::int64_t> stamps_ns = series_stamps_ns(checked);
  ChannelLines lines;
  for (const ShotRecord::Shot& shot : checked.shots) {
    const std::span<const double> values[] = {shot.series->channel(column)};
    const analysis::Frequency& frequency = checked.evaluated.sync_acs.frequency;
    const auto fit = analysis::fit_sine(frequency, 0, stamps_ns, values);
    if (!fit) {
      continue;
    }
    ChannelLines of_shot =
        check_lines(*checked.task.recipe, {"the sensor"},
                    {.channel = channel.text(), .frequency = frequency, .fit = fit->front()},
                    stamps_ns, values[0]);
    if (lines.channel.empty()) {
      lines = std::move(of_shot);
    } else {
      lines.measured.insert(lines.measured.end(), of_shot.measured.begin(), of_shot.measured.end());
    }
  }
  return lines;
}

std::vector<Flag> flags_of_agreement(const analysis::SeriesChannelResult& channel) {
  if (!channel.agreement || !channel.agreement->any()) {
    return {};
  }
  const analysis::SeriesAgreement& found = *channel.agreement;
  std::vector<std::string> what;
  if (found.rates_differ) {
    what.push_back(
        fmt::format("their sample rates scatter by {:.2g} ppm", ppm * found.rate_scatter_rel));
  }
  if (found.phases_change) {
    what.push_back(fmt::format("the phase changes within a series, by up to {:.2g} rad",
                               found.largest_change_rad));
  }
  if (found.magnitudes_change) {
    what.emplace_back("the magnitude changes within all series alike");
  }
  return {flag_of_channel(ResultFlag::shots_disagree, channel.channel,
                          fmt::format("{}", fmt::join(what, "; ")))};
}

} // namespace dyncal::inline evaluation
