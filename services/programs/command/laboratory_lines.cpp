#include "services/programs/command/laboratory_lines.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "services/base/rounding.hpp"
#include "services/evaluation/result/result_flag.hpp"
#include "services/programs/command/harmless_text.hpp"
#include "services/views/report/expanded_uncertainty.hpp"

namespace dyncal::inline programs {
namespace {

using Lines = std::map<std::string, std::string>;

std::string with_message(const std::string& line, const std::string& message) {
  return message.empty() ? line : line + " | " + message;
}

std::string source_line(const network::Bench& bench, const network::Source& source) {
  const drivers::SampleCounts& counts = source.counts;
  return with_message(
      fmt::format("{}/{}: {}, {:.1f} S/s, {} received, {} lost in the device, {} lost on the way, "
                  "{} duplicate, {} rejected, {} stamps not trusted, {} dropped, buffer {:.0f} %, "
                  "{} readers",
                  bench.name, source.name, source.is_silent ? "SILENT" : to_string(source.state),
                  source.rate_hz, counts.received, counts.lost_in_device, counts.lost_on_way,
                  counts.duplicates, counts.rejected, counts.stamps_not_trusted,
                  source.dropped_in_service, source.buffer_fill * 100.0, source.matched_readers),
      source.message);
}

// ", samples_lost (dau: samples lost)"; nothing without flags.
std::string flags_text(const std::vector<Flag>& flags, Lines& lines) {
  std::string text;
  for (const Flag& flag : flags) {
    text += fmt::format(", {} ({})", name_of(flag.kind), flag.sentence);
    lines.emplace(fmt::format("7 {}", name_of(flag.kind)),
                  fmt::format("flag {}: {}", name_of(flag.kind), explanation_of(flag.kind)));
  }
  return text;
}

bool has_several_levels(const network::Run& run) {
  return std::any_of(run.results.begin(), run.results.end(), [&](const auto& one) {
    return one.second.level_m_s2 != run.results.begin()->second.level_m_s2;
  });
}

std::string result_line(const std::string& place, const StepResult& result, bool with_level,
                        Lines& lines) {
  const std::string level = with_level ? fmt::format(", {} m/s^2", result.level_m_s2) : "";
  const std::string head =
      fmt::format("{}: step {}, {} Hz{}, #{}, {}", place, result.step, result.frequency_text_hz,
                  level, result.repetition, result.channel);
  const std::string flags = flags_text(result.flags, lines);
  if (!result.valid) {
    return fmt::format("{}: no result: {}{}", head, result.problem, flags);
  }
  const RoundedValue magnitude = round_by_uncertainty(result.magnitude, result.u_magnitude);
  const RoundedValue phase = round_phase(result.phase_rad, result.u_phase_rad).radians;
  return fmt::format("{}: |H| = {} (u {}), arg H = {} rad (u {}), {} lost{}", head, magnitude.value,
                     magnitude.u, phase.value, phase.u, result.lost, flags);
}

std::string function_line(const std::string& place, const TransferFunction& function,
                          Lines& lines) {
  const std::string head = fmt::format("{}: {}", place, function.channel);
  const std::string flags = flags_text(function.flags, lines);
  if (!function.group_delay) {
    return fmt::format("{}: no group delay: {}{}", head, function.group_delay_problem, flags);
  }
  const RoundedValue ms = round_by_uncertainty(function.group_delay->delay_s * 1e3,
                                               function.group_delay->of_delay.u * 1e3);
  return fmt::format("{}: group delay {} ms (u {}{}){}", head, ms.value, ms.u,
                     notable_k_text(function.group_delay->of_delay.k), flags);
}

std::string clock_line(const std::string& place, const ClockReport& report, Lines& lines) {
  const double rate_hz = report.clock.mean_rate_hz;
  const double u_hz = report.clock.of_mean_rate().u;
  const RoundedValue hz = round_by_uncertainty(rate_hz, u_hz);
  return fmt::format(
      "{}: sample clock of {}: {} Hz (u {}), {} lost{}", place, report.source, hz.value,
      std::isnan(u_hz) ? "not known" : hz.u + notable_k_text(report.clock.k_mean_interval),
      report.clock.lost, flags_text(report.flags, lines));
}

void add_run(const network::Bench& bench, const network::Run& run, Lines& lines) {
  const std::string place = fmt::format("{} {}", bench.name, run.name);
  if (run.analysis) {
    lines.emplace("2 " + place,
                  with_message(fmt::format("{}: {} {}, {} results", place, run.analysis->service,
                                           to_string(run.analysis->state), run.analysis->results),
                               run.analysis->message));
  }
  if (run.announced) {
    lines.emplace(
        "3 " + place,
        with_message(fmt::format("{}: {}", place, to_string(*run.announced)), run.message));
  }
  if (run.now) {
    const network::Step& step = run.now->step;
    const std::string attempt = step.attempt > 1 ? fmt::format(", attempt {}", step.attempt) : "";
    lines.emplace("4 " + place, fmt::format("{}: step {}, {} Hz, {} m/s^2, {}{}", place, step.step,
                                            step.frequency_text_hz, step.level_m_s2,
                                            to_string(step.state), attempt));
  }
  const bool with_level = has_several_levels(run);
  for (const auto& [key, result] : run.results) {
    lines.emplace(
        fmt::format("5 {} {:06} {:06} {}", place, result.repetition, result.step, result.channel),
        result_line(place, result, with_level, lines));
  }
  for (const auto& [channel, function] : run.transfer_functions) {
    lines.emplace(fmt::format("6 {} function {}", place, channel),
                  function_line(place, function, lines));
  }
  for (const auto& [source, report] : run.clock_reports) {
    lines.emplace(fmt::format("6 {} clock {}", place, source), clock_line(place, report, lines));
  }
}

void add_bench(const network::Bench& bench, Lines& lines) {
  for (const auto& [name, source] : bench.sources) {
    lines.emplace(fmt::format("1 {}/{}", bench.name, name), source_line(bench, source));
  }
  for (const auto& [name, service] : bench.services) {
    if (service.is_recorder()) {
      const std::string problem = service.message.empty() ? "" : ": " + service.message;
      lines.emplace(fmt::format("2 {} {}", bench.name, name),
                    fmt::format("{}: recorded in {}, {} messages stored, {} not{}", bench.name,
                                service.recording, service.messages_stored,
                                service.messages_not_stored, problem));
    } else if (service.is_guard()) {
      lines.emplace(fmt::format("2 {} {}", bench.name, name),
                    fmt::format("{}: exciter guarded by {}{}", bench.name, name,
                                service.message.empty() ? "" : ": " + service.message));
    }
  }
  for (const auto& [name, run] : bench.runs) {
    add_run(bench, run, lines);
  }
}

} // namespace

std::string clock_offset_text(const ClockOffset& clock) {
  const RoundedValue offset = round_by_uncertainty(clock.offset_s, clock.bound_s);
  return fmt::format("{}{} s from ours (within {} s)", clock.offset_s > 0.0 ? "+" : "",
                     offset.value, offset.u);
}

std::map<std::string, std::string> laboratory_lines(const network::BusState& laboratory) {
  Lines lines;
  for (const auto& [name, bench] : laboratory.benches()) {
    add_bench(bench, lines);
  }
  for (const HostClock& host : laboratory.clocks()) {
    lines.emplace("0 " + host.host,
                  fmt::format("clock of {}: {}", host.host, clock_offset_text(host.clock)));
  }
  for (auto& [key, line] : lines) {
    line = harmless(line);
  }
  return lines;
}

} // namespace dyncal::inline programs
