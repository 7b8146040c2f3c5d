#include "services/records/store/control_chart.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/uncertainty/coverage.hpp"
#include "services/base/per_enumerator.hpp"
#include "services/records/store/result_record.hpp"
#include "services/views/objections/refusing_flags.hpp"
#include "services/views/report/result_file.hpp"

namespace dyncal::inline records {
namespace {

constexpr double turn_rad = 2.0 * std::numbers::pi;
constexpr double three_sigma_probability = 0.99730020393673979;

// Empty: none.
std::string refusing_flag(const StoredValue& value) {
  for (const std::string& name : value.flag_names) {
    if (verdict_on(parse_flag_name(name)).forbids) {
      return name;
    }
  }
  return "";
}

bool is_known(const StoredValue& value) {
  return std::isfinite(value.magnitude) && value.magnitude > 0.0 && std::isfinite(value.phase_rad);
}

bool responds(const StoredValue& value) {
  constexpr double times_u = 3.0;
  return is_known(value) && value.magnitude > times_u * value.of_magnitude.u;
}

// Of one bench, each run once, none without a value.
std::vector<Calibration> looked_at(std::vector<Calibration> all, const ControlOptions& options) {
  std::erase_if(all,
                [](const Calibration& one) { return std::ranges::none_of(one.points, is_known); });
  const std::string bench =
      options.bench.empty() && !all.empty() ? all.back().run.bench : options.bench;
  std::set<std::string> seen;
  std::erase_if(all, [&](const Calibration& one) {
    return one.run.bench != bench || one.run.began_utc < options.since_utc ||
           !seen.insert(one.run.run + "|" + one.run.began_utc + "|" + one.source).second;
  });
  return all;
}

std::vector<std::size_t> first_complete(const std::vector<Calibration>& calibrations,
                                        std::size_t wanted) {
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i + 1 < calibrations.size() && first.size() < wanted; ++i) {
    if (calibrations[i].run.state == to_string(RunCompletion::complete)) {
      first.push_back(i);
    }
  }
  return first;
}

// Values of one point, by calibration.
struct PointValues {
  std::string frequency_text_hz;
  std::map<std::size_t, const StoredValue*> usable;
  std::string newest_flag{}; // that keeps the newest value out; empty: none
};
using AllPoints = std::map<PointIdentity, PointValues>;

// Of channels that respond at most of their points in the first result.
std::set<std::string> responding_channels_of(const Calibration& calibration) {
  std::map<std::string, int> balance;
  for (const StoredValue& value : calibration.points) {
    balance[value.channel] += responds(value) ? 1 : -1;
  }
  std::set<std::string> channels;
  for (const auto& [channel, above] : balance) {
    if (above > 0) {
      channels.insert(channel);
    }
  }
  return channels;
}

AllPoints points_of(const ControlChart& chart) {
  const auto channels = responding_channels_of(chart.calibrations[chart.first.front()]);
  AllPoints points;
  for (std::size_t i = 0; i < chart.calibrations.size(); ++i) {
    for (const StoredValue& value : chart.calibrations[i].points) {
      if (!channels.contains(value.channel)) {
        continue;
      }
      PointValues& of_point = points[identity_of(value)];
      of_point.frequency_text_hz = value.frequency_text_hz;
      const std::string flag = refusing_flag(value);
      if (is_known(value) && flag.empty()) {
        of_point.usable.emplace(i, &value);
      } else if (i + 1 == chart.calibrations.size()) {
        of_point.newest_flag = flag.empty() ? "no value" : "flag " + flag;
      }
    }
  }
  return points;
}

struct LeftOut {
  std::vector<std::string> not_in_all{};
  std::vector<std::string> missing{};
  std::vector<std::string> flagged{};
};

// Keeps the points that all first results have.
LeftOut leave_out(const ControlChart& chart, AllPoints& points) {
  LeftOut left_out;
  const std::size_t newest = chart.calibrations.size() - 1;
  for (auto one = points.begin(); one != points.end();) {
    const auto& [point, values] = *one;
    const std::string place = to_string(point);
    const bool in_all = std::ranges::all_of(
        chart.first, [&](std::size_t i) { return one->second.usable.contains(i); });
    if (!in_all) {
      left_out.not_in_all.push_back(place);
    } else if (!values.newest_flag.empty()) {
      left_out.flagged.push_back(fmt::format("{} ({})", place, values.newest_flag));
    } else if (!values.usable.contains(newest)) {
      left_out.missing.push_back(place);
    }
    one = in_all ? std::next(one) : points.erase(one);
  }
  return left_out;
}

void note(const char* sentence, const std::vector<std::string>& places, ControlChart& chart) {
  if (!places.empty()) {
    chart.notes.push_back(fmt::format("{}: {}", sentence, fmt::join(places, "; ")));
  }
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Deviations by calibration become a line: centred on the first results.
ControlLine line_of(const ControlChart& chart, ControlQuantity quantity, PointIdentity point,
                    std::string frequency_text_hz, std::map<std::size_t, double> deviations) {
  std::vector<double> first;
  for (const std::size_t i : chart.first) {
    first.push_back(deviations.at(i));
  }
  const double middle = mean_of(first);
  double squares = 0.0;
  for (const double one : first) {
    squares += (one - middle) * (one - middle);
  }
  ControlLine line{.point = std::move(point),
                   .frequency_text_hz = std::move(frequency_text_hz),
                   .quantity = quantity,
                   .centre = middle,
                   .s = std::sqrt(squares / static_cast<double>(first.size() - 1))};
  for (const auto& [calibration, deviation] : deviations) {
    line.values.push_back({calibration, deviation - middle});
  }
  if (line.values.back().calibration + 1 == chart.calibrations.size()) {
    line.newest = line.values.back();
  }
  return line;
}

ControlLine magnitude_line(const ControlChart& chart, const PointIdentity& point,
                           const PointValues& values) {
  std::vector<double> first;
  for (const std::size_t i : chart.first) {
    first.push_back(values.usable.at(i)->magnitude);
  }
  const double centre = mean_of(first);
  std::map<std::size_t, double> deviations;
  for (const auto& [i, value] : values.usable) {
    deviations.emplace(i, value->magnitude / centre - 1.0);
  }
  ControlLine line = line_of(chart, ControlQuantity::magnitude, point, values.frequency_text_hz,
                             std::move(deviations));
  line.centre = centre;
  return line;
}

ControlLine phase_line(const ControlChart& chart, const PointIdentity& point,
                       const PointValues& values) {
  const double origin = values.usable.at(chart.first.front())->phase_rad;
  std::map<std::size_t, double> deviations;
  for (const auto& [i, value] : values.usable) {
    deviations.emplace(i, std::remainder(value->phase_rad - origin, turn_rad));
  }
  ControlLine line = line_of(chart, ControlQuantity::phase, point, values.frequency_text_hz,
                             std::move(deviations));
  line.centre = std::remainder(line.centre + origin, turn_rad);
  return line;
}

// How much each line counts for its whole channel: alike, or as a delay shows in it.
double weight_of(const ControlLine& line) {
  return line.quantity == ControlQuantity::phase ? -turn_rad * line.point.frequency_hz : 1.0;
}

// Least squares of one change in all lines of a channel that the newest result has; nothing for
// results that lack one of them.
void add_whole_channel(ControlQuantity quantity, const std::vector<const ControlLine*>& lines,
                       ControlChart& chart) {
  std::map<std::size_t, double> sums;
  std::map<std::size_t, std::size_t> counts;
  double weights = 0.0;
  for (const ControlLine* line : lines) {
    const double weight = weight_of(*line);
    weights += weight * weight;
    for (const ControlValue& value : line->values) {
      sums[value.calibration] += weight * value.deviation;
      ++counts[value.calibration];
    }
  }
  std::erase_if(sums, [&](const auto& one) { return counts[one.first] < lines.size(); });
  for (auto& [calibration, sum] : sums) {
    sum /= weights;
  }
  const PointIdentity channel{.channel = lines.front()->point.channel};
  chart.lines.push_back(line_of(chart, quantity, channel, "", std::move(sums)));
}

void add_whole_channels(ControlChart& chart) {
  std::map<std::pair<std::string, ControlQuantity>, std::vector<const ControlLine*>> lines;
  const std::vector<ControlLine> single = chart.lines;
  for (const ControlLine& line : single) {
    if (line.newest) {
      lines[{line.point.channel, line.quantity}].push_back(&line);
    }
  }
  for (const auto& [key, of_channel] : lines) {
    if (of_channel.size() > 1) {
      add_whole_channel(key.second == ControlQuantity::phase ? ControlQuantity::delay
                                                             : ControlQuantity::mean_magnitude,
                        of_channel, chart);
    }
  }
}

// Of one among so many lines, each judged by the same few first results.
double limit_factor(double probability, std::size_t first, std::size_t lines) {
  const auto n = static_cast<double>(first);
  const double each = 1.0 - (1.0 - probability) / static_cast<double>(lines);
  return analysis::coverage_factor(n - 1.0, each) * std::sqrt(1.0 + 1.0 / n);
}

void set_limits(const ControlOptions& options, ControlChart& chart) {
  constexpr double warning_part = 2.0 / 3.0;
  constexpr double rounding = 1e-12; // what results of the same bits may differ by
  const double warning =
      limit_factor(analysis::two_sigma_probability, chart.first.size(), chart.lines.size());
  const double action =
      limit_factor(three_sigma_probability, chart.first.size(), chart.lines.size());
  for (ControlLine& line : chart.lines) {
    const auto& given = line.quantity == ControlQuantity::magnitude ? options.limit_magnitude_rel
                        : line.quantity == ControlQuantity::phase   ? options.limit_phase_rad
                                                                    : std::nullopt;
    line.warning = given ? warning_part * *given : warning * line.s + rounding;
    line.action = given ? *given : action * line.s + rounding;
  }
}

CheckState state_of(double deviation, const ControlLine& line) {
  if (std::abs(deviation) > line.action) {
    return CheckState::action;
  }
  return std::abs(deviation) > line.warning ? CheckState::warning : CheckState::in_control;
}

// The first results are what the others are held against.
void judge(ControlChart& chart) {
  chart.state = CheckState::too_few;
  for (ControlLine& line : chart.lines) {
    for (ControlValue& value : line.values) {
      const bool is_first = std::ranges::find(chart.first, value.calibration) != chart.first.end();
      value.state = is_first ? CheckState::in_control : state_of(value.deviation, line);
    }
    if (line.newest) {
      line.newest = line.values.back();
      chart.state = chart.state == CheckState::too_few ? line.newest->state
                                                       : std::max(chart.state, line.newest->state);
    }
  }
}

void note_changes(ControlChart& chart) {
  const Calibration& before = chart.calibrations[chart.first.back()];
  const Calibration& newest = chart.calibrations.back();
  if (before.run.software != newest.run.software) {
    chart.notes.push_back(fmt::format("the first results were evaluated by {}, the newest by {}",
                                      before.run.software, newest.run.software));
  }
  for (const auto& [point, part] : newest.common) {
    const auto same = before.common.find(point);
    if (same != before.common.end() && same->second.origin != part.origin) {
      chart.notes.emplace_back(
          "instruments or corrections are not those of the first results: begin new limits with "
          "--since the day of the change");
      return;
    }
  }
}

} // namespace

std::string to_string(CheckState state) {
  return per_enumerator(state, {"in control", "warning", "action", "too few results"});
}

ControlChart control_chart_of(std::vector<Calibration> calibrations,
                              const ControlOptions& options) {
  ControlChart chart{.calibrations = looked_at(std::move(calibrations), options)};
  chart.bench = chart.calibrations.empty() ? options.bench : chart.calibrations.back().run.bench;
  const std::size_t wanted = std::max(options.first, ControlOptions::least_first);
  chart.first = first_complete(chart.calibrations, wanted);
  if (chart.first.size() < wanted) {
    chart.notes.push_back(fmt::format("limits need {} complete results before the newest one; "
                                      "there are {}",
                                      wanted, chart.first.size()));
    return chart;
  }
  AllPoints points = points_of(chart);
  const LeftOut left_out = leave_out(chart, points);
  for (const auto& [point, values] : points) {
    chart.lines.push_back(magnitude_line(chart, point, values));
    chart.lines.push_back(phase_line(chart, point, values));
  }
  if (!options.limit_magnitude_rel && !options.limit_phase_rad) {
    add_whole_channels(chart);
  }
  set_limits(options, chart);
  judge(chart);
  if (!left_out.flagged.empty() && chart.state == CheckState::in_control) {
    chart.state = CheckState::warning;
  }
  note("not judged, for the newest result has no value to rely on", left_out.flagged, chart);
  note("not in the newest result", left_out.missing, chart);
  note("not judged, for not all of the first results have it", left_out.not_in_all, chart);
  note_changes(chart);
  return chart;
}

} // namespace dyncal::inline records
