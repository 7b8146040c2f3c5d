#include "services/views/report/result_table.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/printable_text.hpp"
#include "services/base/rounding.hpp"
#include "services/contract/unit.hpp"
#include "services/evaluation/result/delay_points.hpp"
#include "services/evaluation/result/point_identity.hpp"
#include "services/views/report/expanded_uncertainty.hpp"
#include "services/views/report/flag_legend.hpp"

namespace dyncal::inline views {
namespace {

using Row = std::vector<std::string>; // as many in every row of a table

// Right-aligned but for the last column.
std::string aligned(const std::vector<Row>& rows) {
  const std::size_t columns = rows.front().size();
  std::vector<std::size_t> width(columns);
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < columns; ++i) {
      width[i] = std::max(width[i], row[i].size());
    }
  }
  std::string text;
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t i = 0; i + 1 < columns; ++i) {
      line += fmt::format("  {:>{}}", row[i], width[i]);
    }
    line += "  " + row.back();
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

Row point_row(const FrequencyPoint& point, const std::vector<Flag>& flags) {
  const RoundedValue magnitude =
      round_by_uncertainty(point.mean.magnitude, magnitude_uncertainty(point.mean).u);
  const RoundedValue phase =
      round_phase(point.mean.phase_rad, phase_uncertainty(point.mean).u).radians;
  return {
      one_line(point.frequency_text_hz),      magnitude.value,  magnitude.u, phase.value, phase.u,
      std::to_string(point.mean.repetitions), flag_names(flags)};
}

// u is that of k = 1: from few repetitions, U needs more than 2 u.
std::string coverage_line(const TransferFunction& function) {
  double max_magnitude = 0.0;
  double max_phase = 0.0;
  for (const FrequencyPoint& point : function.points) {
    max_magnitude = std::max(max_magnitude, magnitude_uncertainty(point.mean).k);
    max_phase = std::max(max_phase, phase_uncertainty(point.mean).k);
  }
  if (std::max(max_magnitude, max_phase) < notable_k) {
    return "";
  }
  const std::string advice = advice_on_repetitions(std::max(max_magnitude, max_phase));
  return fmt::format("  U = k u covers 95.45 % with k up to {:.2f} (|H|) and {:.2f} (arg H); the "
                     "result file has k of every point\n{}",
                     max_magnitude, max_phase, advice.empty() ? "" : "  " + advice + "\n");
}

// Which points the line takes where a frequency has several levels; else empty.
std::string delay_levels_text(const TransferFunction& function) {
  const std::set<double> levels = delay_levels_m_s2(function.points);
  return levels.empty() ? "" : fmt::format(" (of the values at {} m/s^2)", fmt::join(levels, ", "));
}

std::string group_delay_line(const TransferFunction& function) {
  if (function.group_delay) {
    const analysis::GroupDelay& delay = *function.group_delay;
    const RoundedValue ms = round_by_uncertainty(delay.delay_s * 1e3, delay.of_delay.u * 1e3);
    const RoundedValue intercept = round_by_uncertainty(delay.intercept_rad, delay.of_intercept.u);
    return fmt::format("  group delay {} ms, u = {} ms{}; intercept {} rad, u = {} rad{}{}\n",
                       ms.value, ms.u, notable_k_text(delay.of_delay.k), intercept.value,
                       intercept.u, notable_k_text(delay.of_intercept.k),
                       delay_levels_text(function));
  }
  return function.group_delay_problem.empty()
             ? ""
             : fmt::format("  no group delay: {}\n", one_line(function.group_delay_problem));
}

std::string closures_lines(const TransferFunction& function) {
  std::size_t closing = 0;
  std::string open;
  for (const Closure& closure : function.closures) {
    closing += closure.verdict == Verdict::closes ? 1 : 0;
    if (is_open(closure)) {
      open += fmt::format("  open: {}\n", one_line(closure.sentence));
    }
  }
  return function.closures.empty() ? ""
                                   : fmt::format("  closures: {} close{}\n{}", closing,
                                                 open.empty() ? "" : ", but these do not", open);
}

std::string unit_text(const std::string& unit) {
  if (unit.empty()) {
    return ", unit not known: state the units of sensor and reference in the bench file";
  }
  return unit == R"(\one)" ? "" : ", in " + one_line(short_form(unit));
}

std::string axis_text(const TransferFunction& function) {
  return function.excited_axis.empty() ? "" : ", excited axis " + one_line(function.excited_axis);
}

// With the levels where there are several.
std::vector<Row> point_rows(const RunOutcome& outcome, const TransferFunction& function) {
  std::vector<Row> rows{{"f / Hz", "|H|", "u(|H|)", "arg H / rad", "u / rad", "n", "flags"}};
  bool any_flags = false;
  for (const FrequencyPoint& point : function.points) {
    rows.push_back(point_row(point, flags_of(outcome, function.channel, point)));
    any_flags = any_flags || !rows.back().back().empty();
  }
  if (!any_flags) {
    rows.front().back().clear();
  }
  if (have_several_levels(function.points)) {
    rows.front().insert(rows.front().begin() + 1, "level / (m/s^2)");
    for (std::size_t i = 0; i < function.points.size(); ++i) {
      Row& row = rows[i + 1];
      row.insert(row.begin() + 1, fmt::format("{}", function.points[i].level_m_s2));
    }
  }
  return rows;
}

std::string channel_table(const RunOutcome& outcome, const TransferFunction& function) {
  std::string text = fmt::format("\n{}{}{}\n", one_line(function.channel), unit_text(function.unit),
                                 axis_text(function));
  text += aligned(point_rows(outcome, function));
  text += coverage_line(function);
  text += group_delay_line(function);
  text += closures_lines(function);
  if (!function.flags.empty()) {
    text += fmt::format("  flags: {}\n", flag_names(function.flags));
  }
  return text;
}

// A series has no stamps: its rate is known by eq. (6) alone.
std::string series_clock_line(const RunOutcome& outcome, const ClockReport& report) {
  std::set<std::string> starts;
  for (const StepResult& result : outcome.results) {
    if (result.series) {
      starts.insert(result.series->start);
    }
  }
  const analysis::SampleClockStatistics& clock = report.clock;
  const RoundedValue rate = round_by_uncertainty(clock.mean_rate_hz, clock.of_mean_rate().u);
  return fmt::format(
      "\nSample rate of {}: {} Hz, u = {} Hz{}, nominal {:g} Hz; its series start {}\n",
      one_line(report.source), rate.value, rate.u, notable_k_text(clock.k_mean_interval),
      clock.nominal_rate_hz, one_line(fmt::format("{}", fmt::join(starts, " or "))));
}

std::string clock_line(const ClockReport& report) {
  const analysis::SampleClockStatistics& clock = report.clock;
  const RoundedValue mean =
      round_by_uncertainty(clock.mean_interval_s * 1e6, clock.u_mean_interval_s * 1e6);
  const std::vector<std::string> flags = sentences_of(report.flags);
  return fmt::format("\nSample clock of {}: mean interval {} us, sd {:.1f} ns, spread "
                     "{:.0f} ns, {} intervals, {} events, {} samples lost{}{}\n",
                     one_line(report.source),
                     clock.u_mean_interval_s > 0.0
                         ? fmt::format("{} us, u = {}{}", mean.value, mean.u,
                                       notable_k_text(clock.k_mean_interval))
                         : fmt::format("{:.5f}", clock.mean_interval_s * 1e6),
                     clock.sd_s * 1e9, (clock.maximum_s - clock.minimum_s) * 1e9, clock.intervals,
                     clock.event_count, clock.lost, flags.empty() ? "" : "; ",
                     one_line(fmt::format("{}", fmt::join(flags, "; "))));
}

// The steps without a result, each reason once.
std::vector<std::string> problem_lines(const RunOutcome& outcome) {
  std::vector<std::string> lines;
  for (const StepResult& result : outcome.results) {
    std::string line = one_line(
        fmt::format("step {}, {} Hz: {}", result.step, result.frequency_text_hz, result.problem));
    if (!result.valid && std::find(lines.begin(), lines.end(), line) == lines.end()) {
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

// "step 2 (attempt 3), step 7 (attempt 2)"; of all channels of a step once.
std::string repeated_steps(const RunOutcome& outcome) {
  std::map<std::uint32_t, std::uint32_t> attempts;
  for (const StepResult& result : outcome.results) {
    if (result.attempt > 1) {
      attempts[result.step] = result.attempt;
    }
  }
  std::vector<std::string> steps;
  for (const auto& [step, attempt] : attempts) {
    steps.push_back(fmt::format("step {} (attempt {})", step, attempt));
  }
  return steps.empty() ? "" : fmt::format("\nExcited again: {}\n", fmt::join(steps, ", "));
}

std::string pause_lines(const RunOutcome& outcome) {
  std::string text;
  for (const RunPause& pause : outcome.pauses) {
    text += fmt::format("{}  {:.0f} s: {}\n", text.empty() ? "\nPaused:\n" : "",
                        static_cast<double>(pause.ended_utc_ns - pause.began_utc_ns) * 1e-9,
                        one_line(pause.reason));
  }
  return text;
}

// Indented, in lines of a terminal's width; lines after the first one further in.
std::string wrapped(const std::string& line) {
  constexpr std::size_t max_width = 100;
  std::string text;
  std::size_t width = max_width;
  for (std::size_t begin = 0; begin < line.size();) {
    const std::size_t end = std::min(line.find(' ', begin), line.size());
    if (width + 1 + (end - begin) > max_width) {
      text += text.empty() ? " " : "\n   ";
      width = 3;
    }
    text += " " + line.substr(begin, end - begin);
    width += 1 + (end - begin);
    begin = end + 1;
  }
  return text + "\n";
}

// Of channels that are shown, and of steps without a result.
std::string legend(const RunOutcome& outcome) {
  std::vector<Flag> flags;
  const auto add = [&](const std::vector<Flag>& more) {
    flags.insert(flags.end(), more.begin(), more.end());
  };
  for (const TransferFunction& function : outcome.transfer_functions) {
    if (responds(function)) {
      add(flags_of(outcome, function));
    }
  }
  for (const StepResult& result : outcome.results) {
    if (!result.valid) {
      add(result.flags);
    }
  }
  for (const ClockReport& report : outcome.clock_reports) {
    add(report.flags);
  }
  std::string text;
  for (const StoredFlag& flag : flag_legend(flags)) {
    text += (text.empty() ? "\nFlags:\n" : "") + wrapped(one_line(legend_line(flag)));
  }
  if (!text.empty()) {
    text += "  What no flag can tell: what-it-cannot-see.md of the guide\n";
  }
  return text;
}

} // namespace

bool responds(const TransferFunction& function) {
  const auto above = std::count_if(function.points.begin(), function.points.end(),
                                   [](const FrequencyPoint& point) {
                                     return point.mean.magnitude > 3.0 * point.mean.u_magnitude;
                                   });
  return 2 * static_cast<std::size_t>(above) > function.points.size();
}

std::string result_table(const RunOutcome& outcome) {
  std::string text;
  std::vector<std::string> quiet;
  for (const TransferFunction& function : outcome.transfer_functions) {
    if (responds(function)) {
      text += channel_table(outcome, function);
    } else {
      quiet.push_back(one_line(function.channel));
    }
  }
  if (!quiet.empty()) {
    text += fmt::format("\nNo response above three times its uncertainty in: {}\n",
                        fmt::join(quiet, ", "));
  }
  for (const ClockReport& report : outcome.clock_reports) {
    text += report.clock.intervals == 0 ? series_clock_line(outcome, report) : clock_line(report);
  }
  text += repeated_steps(outcome) + pause_lines(outcome);
  const std::vector<std::string> problems = problem_lines(outcome);
  if (!problems.empty()) {
    text += fmt::format("\nWithout a result:\n  {}\n", fmt::join(problems, "\n  "));
  }
  return text + legend(outcome);
}

} // namespace dyncal::inline views
