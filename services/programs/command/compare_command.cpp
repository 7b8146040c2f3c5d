// `dyncal compare A.json B.json`: do two results agree? E_n of ISO/IEC 17043 for magnitude and
// phase at every point that both have.
//
// Compares the transfer functions (means over repetitions) of two result files of dyncal, or their
// single results (--single); |E_n| <= 1, each U at its own k, means that they agree. Points are
// partners as paired_points.hpp says; those without a partner are named, and so are open closures
// of the channels. Group delays are compared as well (compared_delays.hpp). What both have in
// common, such as the reference, can be taken out of the uncertainties of the difference by its
// relative standard uncertainty (--common-magnitude, --common-phase); without that E_n is too kind
// to two results that share a reference.
//
// Prints a table, or JSON. Exit status 0: every point has a partner and agrees with it; 3: not so;
// 1 and one line when a file is not a result or the two have no point in common. Belongs to one
// thread.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "analysis/response/comparison.hpp"
#include "services/base/json_text.hpp"
#include "services/base/printable_text.hpp"
#include "services/base/rounding.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/views/report/compared_delays.hpp"
#include "services/views/report/json_number.hpp"
#include "services/views/report/paired_points.hpp"

namespace dyncal::inline programs {
namespace {

struct CompareOptions {
  std::filesystem::path first;
  std::filesystem::path second;
  std::string first_channel;               // empty: every channel by its own name
  std::string second_channel;              // empty: the same as first_channel
  std::optional<double> first_level_m_s2;  // nothing: every level
  std::optional<double> second_level_m_s2; // nothing: the same as first_level_m_s2
  bool single = false;                     // single results in place of means
  double common_magnitude_rel = 0.0;       // standard uncertainty that both results share
  double common_phase_rad = 0.0;
  bool json = false;
};

void add_compare(CLI::App& command, CompareOptions& compare) {
  command.add_option("A.json", compare.first, "result of dyncal")->required();
  command.add_option("B.json", compare.second, "the other result")->required();
  command.add_option("--channel", compare.first_channel, "only this channel (default: all)");
  command.add_option("--other-channel", compare.second_channel,
                     "its name in the other result (default: the same)");
  command.add_option("--level", compare.first_level_m_s2,
                     "only this planned level, in m/s^2 (default: all)");
  command.add_option("--other-level", compare.second_level_m_s2,
                     "its partner in the other result (default: the same)");
  command.add_flag("--single", compare.single,
                   "compare single results, repetition by repetition, not the means");
  add_checked(command, "--common-magnitude", compare.common_magnitude_rel,
              "relative standard uncertainty that both results share, e.g. of one reference",
              CLI::NonNegativeNumber);
  add_checked(command, "--common-phase", compare.common_phase_rad,
              "standard uncertainty of the phase that both results share, in rad",
              CLI::NonNegativeNumber);
  command.add_flag("--json", compare.json, "print JSON");
  command.footer("Exit status: 0 every point has a partner and agrees with it, 1 failure, 2 wrong "
                 "command line, 3 not so.");
}

using Json = nlohmann::ordered_json;

struct ComparedPoint : PointPair {
  analysis::ComplexComparison comparison;
};

struct ComparedResults {
  std::vector<ComparedPoint> points;
  std::vector<ComparedDelay> delays; // of channels whose frequencies are the same and tell one
  PairedPoints paired;
  std::vector<std::string> first_open; // closures of the channels that are compared
  std::vector<std::string> second_open;
};

Expected<void> check_units(const CompareOptions& command, const PointPair& pair) {
  const std::string& channel = pair.first_identity.channel;
  const std::string& other = pair.second_identity.channel;
  if (pair.first.unit.empty() != pair.second.unit.empty()) {
    const bool first_unknown = pair.first.unit.empty();
    return fail(ErrorCode::bad_file,
                fmt::format("{}: the unit of {} is not known; state the units of sensor and "
                            "reference in its bench file and evaluate it again, or compare "
                            "another channel with --channel",
                            (first_unknown ? command.first : command.second).string(),
                            first_unknown ? channel : other));
  }
  if (pair.first.unit != pair.second.unit) {
    return fail(ErrorCode::bad_file,
                fmt::format("{} is in \"{}\" but {} in \"{}\"; results in different units "
                            "cannot be compared; --channel chooses others",
                            channel, pair.first.unit, other, pair.second.unit));
  }
  return {};
}

// "10 m/s^2", "2, 4 and 8 m/s^2".
std::string levels_text(const std::vector<double>& levels_m_s2) {
  return levels_m_s2.empty() ? "no level" : fmt::format("{} m/s^2", fmt::join(levels_m_s2, ", "));
}

Error nothing_in_common(const CompareOptions& command, const PairedPoints& paired) {
  const auto first = first_levels_m_s2(paired);
  const auto second = second_levels_m_s2(paired);
  std::string sentence = fmt::format("{} and {} have no channel and frequency in common",
                                     command.first.string(), command.second.string());
  if (first != second && !first.empty() && !second.empty()) {
    sentence += fmt::format(" at the same level: {} in the first, {} in the second; --level and "
                            "--other-level compare points of different levels",
                            levels_text(first), levels_text(second));
  }
  return {ErrorCode::bad_file, sentence + "; --channel and --other-channel compare channels of "
                                          "different names"};
}

std::vector<std::string> open_closures(const StoredResult& result, const PairedPoints& paired,
                                       PointIdentity PointPair::*identity) {
  std::set<std::string> channels;
  for (const PointPair& pair : paired.pairs) {
    channels.insert((pair.*identity).channel);
  }
  return result.open_closures({channels.begin(), channels.end()});
}

Expected<ComparedResults> compare(const CompareOptions& command, const StoredResult& first,
                                  const StoredResult& second) {
  const auto points_of = [&](const StoredResult& result) {
    return command.single ? repetitions_of(result) : means_of(result);
  };
  ComparedResults compared;
  compared.paired = pair_points(points_of(first), points_of(second),
                                {.first_channel = command.first_channel,
                                 .second_channel = command.second_channel,
                                 .first_level_m_s2 = command.first_level_m_s2,
                                 .second_level_m_s2 = command.second_level_m_s2});
  for (const PointPair& pair : compared.paired.pairs) {
    DYNCAL_TRY(check_units(command, pair));
    const auto comparison =
        analysis::compare_transfer(pair.first.value, pair.second.value,
                                   {command.common_magnitude_rel, command.common_phase_rad});
    if (!comparison) {
      return fail(ErrorCode::bad_argument, fmt::format("{}: {}", to_string(pair.first_identity),
                                                       comparison.error().message));
    }
    compared.points.push_back({pair, *comparison});
  }
  if (compared.points.empty()) {
    return fail(nothing_in_common(command, compared.paired));
  }
  if (!command.single) {
    compared.delays = compare_delays(first, second, compared.paired);
  }
  compared.first_open = open_closures(first, compared.paired, &PointPair::first_identity);
  compared.second_open = open_closures(second, compared.paired, &PointPair::second_identity);
  return compared;
}

Expected<ComparedResults> read_and_compare(const CompareOptions& command) {
  const WorkProgress progress("reading");
  ByteCount bytes(progress.count(), "reading",
                  bytes_of_file(command.first) + bytes_of_file(command.second));
  DYNCAL_TRY(const auto first, read_values(command.first, bytes));
  DYNCAL_TRY(const auto second, read_values(command.second, bytes));
  progress.count()->begin("comparing", "", 0);
  return compare(command, first, second);
}

bool agrees(const analysis::Difference& difference) {
  return std::abs(difference.normalised_error()) <= 1.0;
}

bool agrees(const ComparedPoint& point) {
  return agrees(point.comparison.magnitude) && agrees(point.comparison.phase);
}

bool agrees(const ComparedDelay& delay) {
  return agrees(delay.difference);
}

auto agreeing(const auto& all) {
  return std::count_if(all.begin(), all.end(), [](const auto& one) { return agrees(one); });
}

bool all_agree(const ComparedResults& compared) {
  return agreeing(compared.points) == std::ssize(compared.points) &&
         agreeing(compared.delays) == std::ssize(compared.delays) &&
         compared.paired.only_first.empty() && compared.paired.only_second.empty();
}

Json json_of(const PointIdentity& point) {
  Json json{{"channel", point.channel},
            {"frequency_hz", point.frequency_hz},
            {"level_m_s2", point.level_m_s2}};
  if (!point.axis.empty()) {
    json["excited_axis"] = point.axis;
  }
  if (point.repetition != 0) {
    json["repetition"] = point.repetition;
  }
  return json;
}

Json json_of(const std::vector<PointIdentity>& points) {
  Json json = Json::array();
  for (const PointIdentity& point : points) {
    json.push_back(json_of(point));
  }
  return json;
}

void add_uncertainty(const std::string& of, const analysis::CombinedUncertainty& uncertainty,
                     Json& json) {
  json["u_" + of] = uncertainty.u;
  json["k_" + of] = uncertainty.k;
  json["U_" + of] = uncertainty.expanded();
  json["nu_eff_" + of] = json_number(uncertainty.degrees_of_freedom);
}

void print_json(const ComparedResults& compared) {
  Json json{{"points", Json::array()}};
  for (const ComparedPoint& point : compared.points) {
    Json one = json_of(point.first_identity);
    one["other_channel"] = point.second_identity.channel;
    one["other_level_m_s2"] = point.second_identity.level_m_s2;
    if (point.first.attempt != 0) {
      one["attempt"] = point.first.attempt;
      one["other_attempt"] = point.second.attempt;
    }
    const auto& [magnitude, phase, chi_squared, probability] = point.comparison;
    one["magnitude_difference"] = magnitude.value;
    add_uncertainty("magnitude_difference", magnitude.of_value, one);
    one["phase_difference_rad"] = phase.value;
    add_uncertainty("phase_difference_rad", phase.of_value, one);
    one["en_magnitude"] = magnitude.normalised_error();
    one["en_phase"] = phase.normalised_error();
    one["agrees"] = agrees(point);
    json["points"].push_back(std::move(one));
  }
  json["agreeing"] = agreeing(compared.points);
  json["group_delays"] = Json::array();
  for (const ComparedDelay& delay : compared.delays) {
    Json one{{"channel", delay.channel},
             {"other_channel", delay.other_channel},
             {"difference_s", delay.difference.value}};
    add_uncertainty("difference_s", delay.difference.of_value, one);
    one["en"] = delay.difference.normalised_error();
    one["agrees"] = agrees(delay);
    json["group_delays"].push_back(std::move(one));
  }
  json["only_first"] = json_of(compared.paired.only_first);
  json["only_second"] = json_of(compared.paired.only_second);
  json["assumed_axis"] =
      compared.paired.assumed_axis.empty() ? Json(nullptr) : Json(compared.paired.assumed_axis);
  json["open_closures_first"] = compared.first_open;
  json["open_closures_second"] = compared.second_open;
  fmt::print("{}\n", json_text(json, 2));
}

// "dau/x", "dau/x and dau/y", "dau/x, axis z".
std::string heading_of(const ComparedPoint& point) {
  const PointIdentity& first = point.first_identity;
  const PointIdentity& second = point.second_identity;
  std::string text =
      first.channel == second.channel ? first.channel : first.channel + " and " + second.channel;
  if (first.level_m_s2 != second.level_m_s2) {
    text += fmt::format(", {} m/s^2 and {} m/s^2", first.level_m_s2, second.level_m_s2);
  }
  return one_line(first.axis.empty() ? text : text + ", axis " + first.axis);
}

// Level and repetition have a column where they tell points apart.
void print_rows(const ComparedResults& compared, bool single) {
  const auto levels = first_levels_m_s2(compared.paired);
  const auto optional_columns = [&](const std::string& level, const std::string& repetition) {
    return (levels.size() > 1 ? fmt::format(" {:>16}", level) : "") +
           (single ? fmt::format(" {:>11}", repetition) : "");
  };
  std::string heading;
  for (const ComparedPoint& point : compared.points) {
    if (const std::string now = heading_of(point); now != heading) {
      fmt::print("{}{}\n{:>12}{} {:>14} {:>9} {:>16} {:>9}\n", heading.empty() ? "" : "\n", now,
                 "f / Hz", optional_columns("level / (m/s^2)", "repetition"), "d|H|", "E_n",
                 "d arg H / rad", "E_n");
      heading = now;
    }
    const PointIdentity& place = point.first_identity;
    fmt::print(
        "{:>12g}{} {:>14.3e} {:>9.2f} {:>16.3e} {:>9.2f}{}\n", place.frequency_hz,
        optional_columns(fmt::format("{}", place.level_m_s2), std::to_string(place.repetition)),
        point.comparison.magnitude.value, point.comparison.magnitude.normalised_error(),
        point.comparison.phase.value, point.comparison.phase.normalised_error(),
        agrees(point) ? "" : "  disagree");
  }
}

void print_delays(const std::vector<ComparedDelay>& delays) {
  for (const ComparedDelay& one : delays) {
    fmt::print(
        "group delay of {}: {} ms and {} ms, E_n {:.2f}{}\n",
        one_line(one.channel == one.other_channel ? one.channel
                                                  : one.channel + " and " + one.other_channel),
        round_by_uncertainty(1e3 * one.delay_s, 1e3 * one.difference.of_value.expanded()).value,
        round_by_uncertainty(1e3 * one.other_delay_s, 1e3 * one.difference.of_value.expanded())
            .value,
        one.difference.normalised_error(), agrees(one) ? "" : "  disagree");
  }
}

// A line a channel.
void print_alone(const std::filesystem::path& file, const std::vector<PointIdentity>& points) {
  for (auto one = points.begin(); one != points.end();) {
    std::vector<std::string> places;
    const std::string& channel = one->channel;
    for (; one != points.end() && one->channel == channel; ++one) {
      places.push_back(place_text(*one));
    }
    fmt::print("  only in {}: {} at {}\n", one_line(file.string()), one_line(channel),
               one_line(fmt::format("{}", fmt::join(places, "; "))));
  }
}

void print_open(const std::filesystem::path& file, const std::vector<std::string>& closures) {
  for (const std::string& sentence : closures) {
    fmt::print("open closure of {}: {}\n", one_line(file.string()), one_line(sentence));
  }
}

void print_table(const CompareOptions& command, const ComparedResults& compared) {
  const PairedPoints& paired = compared.paired;
  print_rows(compared, command.single);
  fmt::print("\n{} of {} points agree (|E_n| <= 1 in magnitude and phase, each U at its own k)\n",
             agreeing(compared.points), compared.points.size());
  print_delays(compared.delays);
  if (const std::size_t alone = paired.only_first.size() + paired.only_second.size(); alone > 0) {
    fmt::print("{} point{} no partner and {} not compared:\n", alone,
               alone == 1 ? " has" : "s have", alone == 1 ? "is" : "are");
    print_alone(command.first, paired.only_first);
    print_alone(command.second, paired.only_second);
  }
  const auto first_levels = first_levels_m_s2(paired);
  const auto second_levels = second_levels_m_s2(paired);
  if (first_levels != second_levels) {
    fmt::print("the levels differ: {} in the first, {} in the second\n", levels_text(first_levels),
               levels_text(second_levels));
  }
  if (!paired.assumed_axis.empty()) {
    fmt::print("one of the two does not state the excited axis; it is taken for {}\n",
               one_line(paired.assumed_axis));
  }
  print_open(command.first, compared.first_open);
  print_open(command.second, compared.second_open);
}

Expected<int> run_compare(const CompareOptions& command) {
  DYNCAL_TRY(const auto compared, read_and_compare(command));
  command.json ? print_json(compared) : print_table(command, compared);
  return all_agree(compared) ? 0 : problems_found;
}

const Command compare_command{
    180, "compare", "compare two results: E_n of magnitude and phase at every common point",
    add_compare, run_compare};

} // namespace
} // namespace dyncal::inline programs
