#include "services/command/laboratory_table.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/core.h>

#include "services/command/harmless_text.hpp"
#include "services/contract/unit.hpp"
#include "services/report/rounding.hpp"

namespace dyncal::services {
namespace {

using bus::Clock;
using live::Bench;
using live::BenchState;
using live::Run;
using live::Severity;

constexpr std::size_t min_columns = 20;

// What stays when there is no room for all; the lowest first.
enum class Rank { always, wrong, channel_of_run, source_of_run, source, channel };

struct Line {
  Rank rank = Rank::always;
  Severity severity = Severity::ok;
  std::string text;
};

Rank rank_of(Severity severity, Rank otherwise) {
  return severity >= Severity::warning ? Rank::wrong : otherwise;
}

bool is_conducted(BenchState state) {
  return state == BenchState::arming || state == BenchState::running || state == BenchState::paused;
}

std::string time_text(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  return whole < 600 ? fmt::format("{} s", whole) : fmt::format("{} min", (whole + 59) / 60);
}

// "step 7 of 51, 40 Hz, steady, 38 s left, run r1"
std::string run_text(const Run& run, Clock::Instant now) {
  if (run.is_over()) {
    return fmt::format("{} results, run {}", run.results.size(), harmless(run.name));
  }
  std::string text;
  if (run.now) {
    text += fmt::format("step {}", run.now->step.step);
    if (run.plan) {
      text += fmt::format(" of {}", run.plan->steps.size());
    }
    text += fmt::format(", {} Hz, {}, ", harmless(run.now->step.frequency_text_hz),
                        to_string(run.now->step.state));
  }
  if (const auto left_s = run.time_left_s(now)) {
    text += fmt::format("{} left, ", time_text(*left_s));
  }
  return text + fmt::format("run {}", harmless(run.name));
}

Line bench_line(const Bench& bench, Clock::Instant now) {
  const live::Condition condition = condition_of(bench, now);
  const BenchState state = state_of(bench, now);
  std::string text =
      fmt::format("{} {:<8}", in_columns(harmless(bench.name), 12), to_string(state));
  if (const Run* run = bench.current_run()) {
    text += " " + run_text(*run, now);
  }
  if (condition.severity >= Severity::warning) {
    text += " | " + harmless(condition.what);
  }
  return {Rank::always, condition.severity, std::move(text)};
}

Line source_line(const live::Source& source, BenchState state, Clock::Instant now) {
  const live::Condition condition = condition_of(source, now);
  const bool silent = source.is_silent && source.state != live::SourceState::ended;
  std::string text =
      fmt::format("  {} {:<8} {:>9.1f} S/s {:>6} lost", // state and figures
                  in_columns(harmless(source.name), 10),
                  silent ? "silent" : to_string(source.state), source.rate_hz, source.lost());
  if (!condition.what.empty()) {
    text += "  " + harmless(condition.what);
  }
  return {rank_of(condition.severity, is_conducted(state) ? Rank::source_of_run : Rank::source),
          condition.severity, std::move(text)};
}

// The newest result of a channel that has a value, and whether most of its values are above their
// noise (as services/report/result_table.hpp decides it).
struct ChannelSummary {
  const StepResult* newest = nullptr;
  std::size_t results = 0;
  std::size_t responding = 0;
  std::size_t flagged = 0;

  [[nodiscard]] bool responds() const { return 2 * responding > results; }
};

std::map<std::string, ChannelSummary> channels_of(const Run& run) {
  std::map<std::string, ChannelSummary> channels;
  for (const auto& [key, result] : run.results) {
    ChannelSummary& channel = channels[result.channel];
    ++channel.results;
    channel.flagged += result.flags.empty() ? 0 : 1;
    if (result.valid) {
      channel.newest = &result; // by step: the last is the newest of its repetition
      channel.responding += result.magnitude > 3.0 * result.u_magnitude ? 1 : 0;
    }
  }
  return channels;
}

Line channel_line(const std::string& name, const ChannelSummary& channel, BenchState state,
                  std::size_t name_columns) {
  std::string text = fmt::format("  {}", in_columns(harmless(name), name_columns));
  if (channel.newest == nullptr) {
    text += fmt::format(" no value in {} results", channel.results);
    return {Rank::wrong, Severity::warning, std::move(text)};
  }
  const StepResult& result = *channel.newest;
  const RoundedValue magnitude = round_by_uncertainty(result.magnitude, result.u_magnitude);
  const RoundedValue phase = round_by_uncertainty(result.phase_rad, result.u_phase_rad);
  const std::string unit = result.unit == R"(\one)" ? "" : " " + short_form(result.unit);
  text += fmt::format(" {:>6} Hz |H| {} u {}{} arg {}", harmless(result.frequency_text_hz),
                      magnitude.value, magnitude.u, harmless(unit), phase.value);
  if (channel.flagged > 0) {
    text += fmt::format(" flags {}", channel.flagged);
  }
  return {is_conducted(state) ? Rank::channel_of_run : Rank::channel,
          channel.flagged > 0 ? Severity::note : Severity::ok, std::move(text)};
}

// As wide as the terminal allows beside a value, up to the longest names that are usual.
std::size_t channel_columns(std::size_t columns) {
  return std::clamp<std::size_t>(columns, 80, 98) - 58;
}

void add_bench(const Bench& bench, Clock::Instant now, const TableLayout& layout,
               std::vector<Line>& lines) {
  const BenchState state = state_of(bench, now);
  if (state == BenchState::gone && !layout.all) {
    return;
  }
  lines.push_back(bench_line(bench, now));
  for (const auto& [name, source] : bench.sources) {
    lines.push_back(source_line(source, state, now));
  }
  for (const auto& [name, run] : bench.runs) {
    const bool is_current = &run == bench.current_run();
    if (!is_current && !layout.all) {
      continue;
    }
    if (!is_current) {
      lines.push_back({Rank::channel, Severity::ok, "  " + run_text(run, now)});
    }
    for (const auto& [channel_name, channel] : channels_of(run)) {
      if (layout.all || channel.responds()) {
        lines.push_back(
            channel_line(channel_name, channel, state, channel_columns(layout.columns)));
      }
    }
  }
}

std::string head(const live::Laboratory& laboratory) {
  std::size_t running = 0;
  const Clock::Instant now = laboratory.clock().now();
  for (const auto& [name, bench] : laboratory.benches()) {
    running += is_conducted(state_of(bench, now)) ? 1 : 0;
  }
  const std::size_t benches = laboratory.benches().size();
  return fmt::format("{} bench{}, {} with a run, {} programs; arg in rad", benches,
                     benches == 1 ? "" : "es", running, laboratory.programs().size());
}

const char* colour_of(Severity severity) {
  switch (severity) {
  case Severity::ok:
    return "";
  case Severity::note:
    return "\x1b[36m";
  case Severity::warning:
    return "\x1b[33m";
  case Severity::error:
    return "\x1b[31m";
  case Severity::stale:
    return "\x1b[2m";
  }
  return "";
}

std::string shortened(const std::string& text, std::size_t columns) {
  return columns_of(text) > columns ? in_columns(text, columns) : text;
}

std::string written(const Line& line, const TableLayout& layout) {
  const std::string text = shortened(line.text, layout.columns);
  const std::string colour = layout.colour ? colour_of(line.severity) : "";
  return colour.empty() ? text : colour + text + "\x1b[0m";
}

// The highest rank of which all lines fit into `rows`, and how many of the next one.
void leave_out(std::vector<Line>& lines, std::size_t rows) {
  std::vector<std::size_t> order(lines.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = i;
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return lines[a].rank < lines[b].rank; });
  order.resize(rows);
  std::sort(order.begin(), order.end());
  std::vector<Line> remaining;
  remaining.reserve(rows);
  for (const std::size_t place : order) {
    remaining.push_back(std::move(lines[place]));
  }
  lines = std::move(remaining);
}

} // namespace

std::vector<std::string> laboratory_table(const live::Laboratory& laboratory,
                                          const TableLayout& wanted) {
  TableLayout layout = wanted;
  layout.columns = std::max(layout.columns, min_columns);
  const Clock::Instant now = laboratory.clock().now();
  std::vector<Line> lines;
  for (const auto& [name, bench] : laboratory.benches()) {
    add_bench(bench, now, layout, lines);
  }
  std::vector<std::string> table{shortened(head(laboratory), layout.columns)};
  if (lines.empty()) {
    table.push_back(shortened("nothing on this DDS domain yet", layout.columns));
  }
  const std::size_t all = lines.size();
  const std::size_t room = std::max<std::size_t>(layout.rows, 3) - 2; // head and last line
  if (layout.rows > 0 && all > room) {
    leave_out(lines, room);
  }
  for (const Line& line : lines) {
    table.push_back(written(line, layout));
  }
  if (lines.size() < all) {
    table.push_back(shortened(
        fmt::format("{} more lines: a higher window, or --bench NAME", all - lines.size()),
        layout.columns));
  }
  return table;
}

} // namespace dyncal::services
