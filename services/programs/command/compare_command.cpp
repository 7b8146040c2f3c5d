// `dyncal compare A.json B.json`: do two results agree? E_n of ISO/IEC 17043 for magnitude and
// phase at every frequency that both have.
//
// Compares the transfer functions (means over repetitions) of two result files of dyncal; |E_n| <=
// 1, each U at its own k, means that they agree. What both have in common, such as the reference,
// can be taken out of the uncertainties of the difference by its relative standard uncertainty
// (--common-magnitude, --common-phase); without that E_n is too kind to two results that share a
// reference. Prints a table, or JSON. Exit status 1 and one line when a file is not a result or the
// two have nothing in common. Belongs to one thread.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "analysis/response/comparison.hpp"
#include "services/base/json_text.hpp"
#include "services/base/printable_text.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/views/report/result_file.hpp"

namespace dyncal::inline programs {
namespace {

struct CompareOptions {
  std::filesystem::path first;
  std::filesystem::path second;
  std::string first_channel;         // empty: every channel by its own name
  std::string second_channel;        // empty: the same as first_channel
  double common_magnitude_rel = 0.0; // standard uncertainty that both results share
  double common_phase_rad = 0.0;
  bool json = false;
};

void add_compare(CLI::App& command, CompareOptions& compare) {
  command.add_option("A.json", compare.first, "result of dyncal")->required();
  command.add_option("B.json", compare.second, "the other result")->required();
  command.add_option("--channel", compare.first_channel, "only this channel (default: all)");
  command.add_option("--other-channel", compare.second_channel,
                     "its name in the other result (default: the same)");
  add_checked(command, "--common-magnitude", compare.common_magnitude_rel,
              "relative standard uncertainty that both results share, e.g. of one reference",
              CLI::NonNegativeNumber);
  add_checked(command, "--common-phase", compare.common_phase_rad,
              "standard uncertainty of the phase that both results share, in rad",
              CLI::NonNegativeNumber);
  command.add_flag("--json", compare.json, "print JSON");
}

using Json = nlohmann::ordered_json;

struct ComparedPoint {
  std::string first_channel;
  std::string second_channel;
  double frequency_hz = 0.0;
  analysis::ComparedResult first;
  analysis::ComparedResult second;
  analysis::ComplexComparison comparison;
};

Expected<std::vector<ComparedPoint>>
compare(const CompareOptions& command, const ResultPoints& first, const ResultPoints& second) {
  std::vector<ComparedPoint> compared;
  for (const auto& [place, point] : first) {
    const auto& [channel, frequency_hz] = place;
    if (!command.first_channel.empty() && channel != command.first_channel) {
      continue;
    }
    const std::string& other = command.second_channel.empty() ? channel : command.second_channel;
    const auto match = second.find({other, frequency_hz});
    if (match == second.end()) {
      continue;
    }
    if (match->second.unit.empty() != point.unit.empty()) {
      const bool first_unknown = point.unit.empty();
      return fail(ErrorCode::bad_file,
                  fmt::format("{}: the unit of {} is not known; state the units of sensor and "
                              "reference in its bench file and evaluate it again, or compare "
                              "another channel with --channel",
                              (first_unknown ? command.first : command.second).string(),
                              first_unknown ? channel : other));
    }
    if (match->second.unit != point.unit) {
      return fail(ErrorCode::bad_file,
                  fmt::format("{} is in \"{}\" but {} in \"{}\"; results in different units "
                              "cannot be compared; --channel chooses others",
                              channel, point.unit, other, match->second.unit));
    }
    const auto comparison = analysis::compare_transfer(
        point.value, match->second.value, {command.common_magnitude_rel, command.common_phase_rad});
    if (!comparison) {
      return fail(ErrorCode::no_result, fmt::format("{} at {} Hz: {}", channel, frequency_hz,
                                                    comparison.error().message));
    }
    compared.push_back(
        {channel, other, frequency_hz, point.value, match->second.value, *comparison});
  }
  if (compared.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{} and {} have no channel and frequency in common; --channel and "
                            "--other-channel compare channels of different names",
                            command.first.string(), command.second.string()));
  }
  return compared;
}

Expected<std::vector<ComparedPoint>> read_and_compare(const CompareOptions& command) {
  const WorkProgress progress("reading");
  ByteCount bytes(progress.count(), "reading",
                  bytes_of_file(command.first) + bytes_of_file(command.second));
  DYNCAL_TRY(const auto first, read_result_file(command.first, bytes));
  DYNCAL_TRY(const auto second, read_result_file(command.second, bytes));
  progress.count()->begin("comparing", "", 0);
  return compare(command, first, second);
}

double phase_difference_rad(const ComparedPoint& point) {
  return std::remainder(point.first.phase_rad - point.second.phase_rad, 2.0 * std::numbers::pi);
}

bool agrees(const ComparedPoint& point) {
  return std::abs(point.comparison.en_magnitude) <= 1.0 &&
         std::abs(point.comparison.en_phase) <= 1.0;
}

void print_json(const std::vector<ComparedPoint>& points) {
  Json json{{"points", Json::array()}};
  for (const ComparedPoint& point : points) {
    json["points"].push_back(
        {{"channel", point.first_channel},
         {"other_channel", point.second_channel},
         {"frequency_hz", point.frequency_hz},
         {"magnitude_difference", point.first.magnitude - point.second.magnitude},
         {"phase_difference_rad", phase_difference_rad(point)},
         {"en_magnitude", point.comparison.en_magnitude},
         {"en_phase", point.comparison.en_phase},
         {"agrees", agrees(point)}});
  }
  json["agreeing"] = std::count_if(points.begin(), points.end(), agrees);
  fmt::print("{}\n", json_text(json, 2));
}

void print_table(const std::vector<ComparedPoint>& points) {
  std::string channel;
  for (const ComparedPoint& point : points) {
    if (point.first_channel != channel) {
      channel = point.first_channel;
      fmt::print("{}{}\n{:>12} {:>14} {:>9} {:>16} {:>9}\n",
                 channel == points.front().first_channel ? "" : "\n",
                 one_line(point.second_channel == channel
                              ? channel
                              : channel + " and " + point.second_channel),
                 "f / Hz", "d|H|", "E_n", "d arg H / rad", "E_n");
    }
    fmt::print("{:>12g} {:>14.3e} {:>9.2f} {:>16.3e} {:>9.2f}{}\n", point.frequency_hz,
               point.first.magnitude - point.second.magnitude, point.comparison.en_magnitude,
               phase_difference_rad(point), point.comparison.en_phase,
               agrees(point) ? "" : "  disagree");
  }
  fmt::print("\n{} of {} points agree (|E_n| <= 1 in magnitude and phase, each U at its own k)\n",
             std::count_if(points.begin(), points.end(), agrees), points.size());
}

Expected<void> run_compare(const CompareOptions& command) {
  DYNCAL_TRY(const auto compared, read_and_compare(command));
  command.json ? print_json(compared) : print_table(compared);
  return {};
}

const Command compare_command{
    180, "compare", "compare two results: E_n of magnitude and phase at every common frequency",
    add_compare, run_compare};

} // namespace
} // namespace dyncal::inline programs
