#include "services/programs/command/laboratory_table.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "services/base/rounding.hpp"
#include "services/contract/run_identity.hpp"
#include "services/contract/unit.hpp"
#include "services/programs/command/harmless_text.hpp"
#include "services/programs/command/laboratory_lines.hpp"
#include "services/programs/command/work_progress.hpp"

namespace dyncal::inline programs {
namespace {

using bus::Clock;
using network::Bench;
using network::BenchState;
using network::Run;

constexpr std::size_t min_columns = 20;

// What stays when there is no room for all; the lowest first.
enum class Rank { always, wrong, channel_of_run, meaning, source_of_run, source, channel };

struct Line {
  Rank rank = Rank::always;
  Severity severity = Severity::ok;
  std::string text;
};

std::string shortened(const std::string& text, std::size_t columns) {
  return columns_of(text) > columns ? in_columns(text, columns) : text;
}

Rank rank_of(Severity severity, Rank otherwise) {
  return severity >= Severity::warning ? Rank::wrong : otherwise;
}

bool is_conducted(BenchState state) {
  return state == BenchState::arming || state == BenchState::running || state == BenchState::paused;
}

// "step 7 of 51, 40 Hz, steady, 38 s left, run r1"
std::string run_text(const Run& run, Clock::Instant now) {
  if (run.is_over()) {
    return fmt::format("{} results, run {}", run.results.size(),
                       harmless(RunIdentity::parse(run.name).name));
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
    text += fmt::format("{} left, ", duration_text(*left_s));
  }
  return text + fmt::format("run {}", harmless(RunIdentity::parse(run.name).name));
}

Line bench_line(const Bench& bench, Clock::Instant now) {
  const network::Condition condition = condition_of(bench, now);
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

Line source_line(const network::Source& source, BenchState state, Clock::Instant now) {
  const network::Condition condition = condition_of(source, now);
  const bool silent = source.is_silent && source.state != network::SourceState::ended;
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
// noise (as services/views/report/result_table.hpp decides it).
struct ChannelSummary {
  const StepResult* newest = nullptr;
  std::size_t results = 0;
  std::size_t responding = 0;
  std::size_t flagged = 0;
  std::map<ResultFlag, std::size_t> flags; // how many results have it

  [[nodiscard]] bool responds() const { return 2 * responding > results; }
};

std::map<std::string, ChannelSummary> channels_of(const Run& run) {
  std::map<std::string, ChannelSummary> channels;
  for (const auto& [key, result] : run.results) {
    ChannelSummary& channel = channels[result.channel];
    ++channel.results;
    channel.flagged += result.flags.empty() ? 0 : 1;
    std::set<ResultFlag> kinds;
    for (const Flag& flag : result.flags) {
      kinds.insert(flag.kind);
    }
    for (const ResultFlag kind : kinds) {
      ++channel.flags[kind];
    }
    if (result.valid) {
      channel.newest = &result; // by step: the last is the newest of its repetition
      channel.responding += result.magnitude > 3.0 * result.u_magnitude ? 1 : 0;
    }
  }
  return channels;
}

bool is_shown(const Bench& bench, Clock::Instant now, const TableLayout& layout) {
  return layout.all || state_of(bench, now) != BenchState::gone;
}

bool is_shown(const Run& run, const Bench& bench, const TableLayout& layout) {
  return layout.all || &run == bench.current_run();
}

bool is_shown(const ChannelSummary& channel, const TableLayout& layout) {
  return layout.all || channel.responds();
}

// Of the names of channels: as wide as the widest, as long as there is room for values beside it.
std::size_t name_columns(const network::BusState& laboratory, Clock::Instant now,
                         const TableLayout& layout) {
  std::size_t widest = 0;
  for (const auto& [bench_name, bench] : laboratory.benches()) {
    for (const auto& [run_name, run] : bench.runs) {
      if (!is_shown(bench, now, layout) || !is_shown(run, bench, layout)) {
        continue;
      }
      for (const auto& [name, channel] : channels_of(run)) {
        widest = is_shown(channel, layout) ? std::max(widest, columns_of(harmless(name))) : widest;
      }
    }
  }
  return std::min(widest, std::clamp<std::size_t>(layout.columns, 80, 98) - 58);
}

// Of the texts that say it, the one that says most within `columns`.
std::string flags_text(const ChannelSummary& channel, std::size_t columns) {
  const std::string name = fmt::format("{}{}", name_of(channel.flags.begin()->first),
                                       channel.flags.size() > 1 ? "+" : "");
  std::string text = fmt::format(" flags {}: {}", channel.flagged, name);
  if (columns_of(text) > columns) {
    text = " " + name;
  }
  if (columns_of(text) > columns) {
    text = fmt::format(" flags {}", channel.flagged);
  }
  return text;
}

Line channel_line(const std::string& name, const ChannelSummary& channel, BenchState state,
                  std::size_t names, std::size_t columns) {
  std::string text = fmt::format("  {}", in_columns(harmless(name), names));
  if (channel.newest == nullptr) {
    text += fmt::format(" no value in {} results", channel.results);
    return {Rank::wrong, Severity::warning, std::move(text)};
  }
  const StepResult& result = *channel.newest;
  const RoundedValue magnitude = round_by_uncertainty(result.magnitude, result.u_magnitude);
  const RoundedValue phase = round_phase(result.phase_rad, result.u_phase_rad).radians;
  const std::string unit = result.unit == R"(\one)" ? "" : " " + short_form(result.unit);
  text += fmt::format(" {:>6} Hz |H| {} u {}{} arg {}", harmless(result.frequency_text_hz),
                      magnitude.value, magnitude.u, harmless(unit), phase.value);
  if (channel.flagged > 0) {
    text += flags_text(channel, columns - std::min(columns_of(text), columns));
  }
  return {is_conducted(state) ? Rank::channel_of_run : Rank::channel,
          channel.flagged > 0 ? Severity::note : Severity::ok, std::move(text)};
}

// A text over several lines, the first begins at `indent`, the others further in.
void add_wrapped(const std::string& text, std::size_t indent, Rank rank, std::size_t columns,
                 std::vector<Line>& lines) {
  std::string line(indent, ' ');
  bool begun = false;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find(' ', from), text.size());
    const std::string word = text.substr(from, end - from);
    if (begun && columns_of(line) + 1 + columns_of(word) > columns) {
      lines.push_back({rank, Severity::note, std::exchange(line, std::string(indent + 2, ' '))});
      begun = false;
    }
    line += (begun ? " " : "") + word;
    begun = true;
    from = end + 1;
  }
  lines.push_back({rank, Severity::note, std::move(line)});
}

struct Table {
  TableLayout layout;
  Clock::Instant now;
  std::size_t names = 0; // columns of the names of channels
  std::vector<Line> lines{};
  std::set<ResultFlag> flags{}; // that are in it by name
};

void add_channel(const std::string& name, const ChannelSummary& channel, BenchState state,
                 Table& table) {
  const std::size_t columns = table.layout.columns;
  Line line = channel_line(name, channel, state, table.names, columns);
  const Rank rank = line.rank;
  table.lines.push_back(std::move(line));
  if (table.layout.flags && !channel.flags.empty()) {
    std::string text; // "samples_lost 3, values_stuck 1": how many results have it
    for (const auto& [kind, results] : channel.flags) {
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name_of(kind), results);
      table.flags.insert(kind);
    }
    add_wrapped(text, 4, rank, columns, table.lines);
  }
}

void add_meanings(Table& table) {
  for (const ResultFlag kind : table.flags) {
    add_wrapped(fmt::format("{}: {}", name_of(kind), explanation_of(kind)), 0, Rank::meaning,
                table.layout.columns, table.lines);
  }
}

void add_bench(const Bench& bench, Table& table) {
  const TableLayout& layout = table.layout;
  const Clock::Instant now = table.now;
  std::vector<Line>& lines = table.lines;
  if (!is_shown(bench, now, layout)) {
    return;
  }
  const BenchState state = state_of(bench, now);
  lines.push_back(bench_line(bench, now));
  for (const auto& [name, source] : bench.sources) {
    lines.push_back(source_line(source, state, now));
  }
  for (const auto& [name, run] : bench.runs) {
    if (!is_shown(run, bench, layout)) {
      continue;
    }
    if (&run != bench.current_run()) {
      lines.push_back({Rank::channel, Severity::ok, "  " + run_text(run, now)});
    }
    for (const auto& [channel_name, channel] : channels_of(run)) {
      if (is_shown(channel, layout)) {
        add_channel(channel_name, channel, state, table);
      }
    }
  }
}

// What a long name of a host leaves no room for is the name, not the offset.
Line clock_line(const HostClock& host, std::size_t columns) {
  constexpr std::size_t min_name = 8;
  const std::string begin = "clock of ";
  const std::string offset = ": " + clock_offset_text(host.clock);
  const std::size_t others = columns_of(begin) + columns_of(offset);
  const std::size_t room = std::max(columns, others + min_name) - others;
  std::string text = begin + shortened(harmless(host.host), room) + offset;
  return is_notable(host.clock) ? Line{Rank::wrong, Severity::warning, std::move(text)}
                                : Line{Rank::source, Severity::ok, std::move(text)};
}

// Of hosts whose clock is off, with `all` of each that is not ours.
void add_clocks(const network::BusState& laboratory, Table& table) {
  for (const HostClock& host : laboratory.clocks()) {
    if (table.layout.all || is_notable(host.clock)) {
      table.lines.push_back(clock_line(host, table.layout.columns));
    }
  }
}

std::string head(const network::BusState& laboratory) {
  const Clock::Instant now = laboratory.clock().now();
  const auto running = std::ranges::count_if(laboratory.benches(), [&](const auto& named) {
    return is_conducted(state_of(named.second, now));
  });
  const std::size_t benches = laboratory.benches().size();
  return fmt::format("{} bench{}, {} with a run, {} programs; arg in rad", benches,
                     benches == 1 ? "" : "es", running, laboratory.programs().size());
}

const char* colour_of(Severity severity) { // ok, note, warning, error, stale
  constexpr std::array colours{"", "\x1b[36m", "\x1b[33m", "\x1b[31m", "\x1b[2m"};
  return colours.at(static_cast<std::size_t>(severity));
}

std::string written(const Line& line, const TableLayout& layout) {
  const std::string text = shortened(line.text, layout.columns);
  const std::string colour = layout.colour ? colour_of(line.severity) : "";
  return colour.empty() ? text : colour + text + "\x1b[0m";
}

// The highest rank of which all lines fit into `rows`, and how many of the next one.
void leave_out(std::vector<Line>& lines, std::size_t rows) {
  std::vector<std::size_t> order(lines.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t place) { return lines[place].rank; });
  order.resize(rows);
  std::ranges::sort(order);
  std::vector<Line> remaining;
  for (const std::size_t place : order) {
    remaining.push_back(std::move(lines[place]));
  }
  lines = std::move(remaining);
}

} // namespace

std::vector<std::string> laboratory_table(const network::BusState& laboratory,
                                          const TableLayout& wanted) {
  TableLayout layout = wanted;
  layout.columns = std::max(layout.columns, min_columns);
  const Clock::Instant now = laboratory.clock().now();
  Table found{layout, now, name_columns(laboratory, now, layout)};
  for (const auto& [name, bench] : laboratory.benches()) {
    add_bench(bench, found);
  }
  add_clocks(laboratory, found);
  add_meanings(found);
  std::vector<Line>& lines = found.lines;
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

} // namespace dyncal::inline programs
