#include "services/bench/file/bench_tables.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/core.h>
#include <toml++/toml.h>

#include "analysis/base/frequency.hpp"
#include "analysis/base/preferred_frequencies.hpp"
#include "services/bench/file/excitation_levels.hpp"
#include "services/bench/file/multisine_keys.hpp"

namespace dyncal::inline bench {
namespace {

constexpr int max_attempts = 10;
constexpr int max_repetitions = 1000;
constexpr std::size_t max_axis_bytes = 16;
constexpr double max_step_s = 86'400.0; // settling or duration of one step: a day
// What one message of the plan carries, and more than anybody waits for.
constexpr std::size_t max_steps = 10'000;

void read_axis(TomlTable& table, ExcitationSettings& excitation) {
  excitation.axis = table.text("axis");
  const bool is_name = std::all_of(excitation.axis.begin(), excitation.axis.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '+' || c == '-' || c == '_';
  });
  if (table.has("axis") &&
      (!is_name || excitation.axis.empty() || excitation.axis.size() > max_axis_bytes)) {
    table.refuse("axis", "must be \"x\", \"y\", \"z\" or another name of 1 to 16 letters, digits, "
                         "+, - and _");
  }
}

void read_transverse_motion(TomlTable table, ExcitationSettings& excitation) {
  const std::vector<double> ratios = table.numbers("ratio", "of the motion along the axis");
  const std::vector<double> frequencies_hz = table.numbers("frequencies_hz", "Hz");
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    if (!(ratios[i] >= 0.0 && ratios[i] <= 1.0)) {
      table.refuse_entry("ratio", i, "must be between 0 and 1; is it given in per cent?");
    }
  }
  if (ratios.empty()) {
    table.refuse("ratio", "is missing: the largest motion across the axis, over that along it");
  } else if (frequencies_hz.empty() ? ratios.size() != 1 : ratios.size() != frequencies_hz.size()) {
    table.refuse("ratio", "needs one entry for each of 'frequencies_hz'; one alone holds at all");
  }
  for (std::size_t i = 0; i < std::max(ratios.size(), frequencies_hz.size()); ++i) {
    const bool has_frequency = i < frequencies_hz.size();
    if (has_frequency && !(frequencies_hz[i] > 0.0)) {
      table.refuse_entry("frequencies_hz", i, "must be positive, in Hz");
    }
    excitation.transverse_motion.points.push_back(
        {has_frequency ? frequencies_hz[i] : 0.0, i < ratios.size() ? ratios[i] : 0.0});
  }
  excitation.transverse_motion.source = table.required_text("source");
  if (excitation.axis.empty()) {
    table.refuse("ratio", "needs excitation.axis, which it is across");
  }
  table.finish();
}

void read_window(TomlTable& table, ExcitationSettings& excitation) {
  excitation.whole_record =
      table.one_of("window", {"search", "whole-record"}, "search") == "whole-record";
  if (!excitation.whole_record) {
    return;
  }
  if (excitation.frequencies_hz.size() != 1 || excitation.repetitions != 1) {
    table.refuse("window", "can be \"whole-record\" for one frequency and one repetition only: "
                           "records of several steps must be searched");
  }
  for (const char* key : {"settling", "settling_s", "duration_s"}) {
    if (table.has(key)) {
      table.refuse(key,
                   "has no meaning when window is \"whole-record\": every sample is evaluated");
    }
  }
}

void check_number_of_steps(TomlTable& table, const ExcitationSettings& excitation) {
  const std::size_t steps =
      excitation.frequencies_hz.size() * static_cast<std::size_t>(excitation.repetitions);
  if (excitation.repetitions > max_repetitions) {
    table.refuse("repetitions", fmt::format("must be between 1 and {}", max_repetitions));
  } else if (steps > max_steps) {
    table.refuse("repetitions",
                 fmt::format("makes {} steps of {} frequencies; a run has at most {}", steps,
                             excitation.frequencies_hz.size(), max_steps));
  }
}

// A list, or those of ISO 266 in a range.
std::vector<std::string> read_frequencies(TomlTable& table) {
  const toml::node* node = table.node("frequencies_hz");
  if (node == nullptr || !node->is_string()) {
    return table.texts("frequencies_hz");
  }
  auto preferred = analysis::preferred_frequencies(node->as_string()->get());
  if (!preferred || preferred->empty()) {
    table.refuse("frequencies_hz",
                 "must be a list, or a range of ISO 266 that holds one: \"third-octave 10..200\", "
                 "\"octave 16..1000\"");
    return {};
  }
  return std::move(*preferred);
}

} // namespace

ExcitationSettings read_excitation(TomlTable table) {
  ExcitationSettings excitation;
  excitation.frequencies_hz = read_frequencies(table);
  if (excitation.frequencies_hz.empty() && !table.refused("frequencies_hz")) {
    table.refuse(
        "frequencies_hz",
        "must list at least one frequency as decimal text, for example [\"10\", \"12.5\"]");
  }
  for (std::size_t i = 0; i < excitation.frequencies_hz.size(); ++i) {
    const std::string& text = excitation.frequencies_hz[i];
    if (const auto frequency = analysis::Frequency::parse(text); !frequency) {
      table.refuse_entry("frequencies_hz", i,
                         fmt::format("holds \"{}\", which is not a positive number in Hz", text));
    }
  }
  excitation.levels_m_s2 = read_levels(table, excitation.frequencies_hz);
  excitation.level_deviation_rel =
      table.optional_number("level_deviation_rel", "parts of the level");
  if (excitation.level_deviation_rel && *excitation.level_deviation_rel <= 0.0) {
    table.refuse("level_deviation_rel", "must be positive: 0.1 flags steps that are off by 10 %");
  }
  read_axis(table, excitation);
  if (auto motion = table.table("transverse_motion")) {
    read_transverse_motion(std::move(*motion), excitation);
  }
  excitation.repetitions = table.whole_number("repetitions", 1, 1);
  check_number_of_steps(table, excitation);
  excitation.repeat_first = table.yes_no("repeat_first", excitation.repeat_first);
  excitation.attempts = table.whole_number("attempts", excitation.attempts, 1);
  if (excitation.attempts > max_attempts) {
    table.refuse("attempts", fmt::format("must be between 1 and {}", max_attempts));
  }
  excitation.settling_s = table.number("settling_s", excitation.settling_s, "seconds");
  excitation.duration_s = table.number("duration_s", excitation.duration_s, "seconds");
  if (!(excitation.settling_s >= 0.0 && excitation.settling_s <= max_step_s)) {
    table.refuse("settling_s", fmt::format("must be between 0 and {} s, a day", max_step_s));
  }
  if (!(excitation.duration_s > 0.0 && excitation.duration_s <= max_step_s)) {
    table.refuse("duration_s", fmt::format("must be above 0 and at most {} s, a day", max_step_s));
  }
  excitation.settling_from_data =
      table.one_of("settling", {"fixed", "from-data"}, "fixed") == "from-data";
  read_window(table, excitation);
  read_multisine(table, excitation);
  table.finish();
  return excitation;
}

} // namespace dyncal::inline bench
