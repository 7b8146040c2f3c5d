#include "services/views/report/combined_result.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/core.h>

#include "services/base/version.hpp"
#include "services/evaluation/combined_mountings.hpp"
#include "services/views/report/amendments.hpp"
#include "services/views/report/combined_conditions.hpp"
#include "services/views/report/result_json.hpp"
#include "services/views/report/result_table.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

using Names = std::vector<std::string>;

tl::unexpected<Error> refuse(const StoredResult& one, const StoredResult& other,
                             const std::string& what) {
  return fail(ErrorCode::bad_argument,
              fmt::format("runs '{}' and '{}' cannot be combined: {}", one.run, other.run, what));
}

Expected<void> check_whole(const StoredResult& run) {
  if (run.interrupted || !run.problem.empty()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("run '{}' {}; combine runs that are whole", run.run,
                            run.interrupted ? "was interrupted" : "ended early: " + run.problem));
  }
  return {};
}

Expected<void> check_same_sensor(const StoredResult& one, const StoredResult& other) {
  for (const StoredChannel& channel : one.channels) {
    const auto a = described_source(one, channel.channel);
    const auto b = described_source(other, channel.channel);
    if (a && b && (a->serial != b->serial || a->device != b->device)) {
      return refuse(one, other,
                    fmt::format("{} is of sensor '{}' with serial number '{}' in one, of '{}' with "
                                "'{}' in the other",
                                channel.channel, a->device, a->serial, b->device, b->serial));
    }
  }
  return {};
}

// What the values are traceable to, and what the ADC was corrected by.
std::string certificates_of(const StoredResult& run) {
  std::string text;
  if (run.corrections && run.corrections->reference_standard) {
    for (const CalibratedDevice& device : run.corrections->reference_standard->devices) {
      text += fmt::format("{} {} {}, ", device.name, device.serial, device.certificate);
    }
  }
  if (run.corrections && run.corrections->adc_file) {
    text += "ADC " + run.corrections->adc_file->sha256;
  }
  return text.empty() ? "none stated" : text;
}

Expected<void> check_same_measurement(const StoredResult& one, const StoredResult& other) {
  // Evaluated from files, all runs have one name.
  const bool is_one_run = one.run == other.run && one.began_utc == other.began_utc;
  if (one.sha256 == other.sha256 || is_one_run) {
    return refuse(one, other, "it is one run");
  }
  if (one.method != other.method) {
    return refuse(one, other, "their methods differ");
  }
  if (certificates_of(one) != certificates_of(other)) {
    return refuse(one, other,
                  fmt::format("their references differ ({}; {}), and a document names one",
                              certificates_of(one), certificates_of(other)));
  }
  for (const StoredValue& value : one.values) {
    for (const StoredValue& same : other.values) {
      if (same.channel == value.channel &&
          (same.unit != value.unit || same.excited_axis != value.excited_axis)) {
        return refuse(one, other,
                      fmt::format("{} has another unit or excited axis", value.channel));
      }
    }
  }
  return check_same_sensor(one, other);
}

void add_once(const Names& names, Names& all) {
  for (const std::string& name : names) {
    if (std::ranges::find(all, name) == all.end()) {
      all.push_back(name);
    }
  }
}

// A file states units of channels alone.
std::vector<StepResult> steps_of(const StoredResult& run) {
  std::vector<StepResult> steps(run.points.begin(), run.points.end());
  for (StepResult& step : steps) {
    const auto channel = std::ranges::find(run.channels, step.channel, &StoredChannel::channel);
    step.unit = channel == run.channels.end() ? "" : channel->unit;
  }
  return steps;
}

// Sentences and names of the flags of a point in all runs.
void add_flags_of_runs(const std::vector<StoredResult>& runs, StoredValue& value) {
  for (const StoredResult& run : runs) {
    for (const StoredValue& one : run.values) {
      if (one.channel == value.channel && one.frequency_hz == value.frequency_hz &&
          one.level_m_s2 == value.level_m_s2) {
        add_once(one.flags, value.flags);
        add_once(one.flag_names, value.flag_names);
      }
    }
  }
}

StoredPoint stored_point(const StepResult& mounting, const StoredResult& run) {
  StoredPoint point;
  static_cast<StepResult&>(point) = mounting;
  for (const StoredPoint& one : run.points) {
    if (one.valid && one.channel == mounting.channel && one.frequency_hz == mounting.frequency_hz &&
        one.level_m_s2 == mounting.level_m_s2) {
      add_once(one.sentences, point.sentences);
      add_once(one.flag_names, point.flag_names);
    }
  }
  point.of_magnitude = magnitude_uncertainty(mounting);
  point.of_phase = phase_uncertainty(mounting);
  return point;
}

// What describes all of them, from the first; when, from all.
StoredResult head_of(const std::vector<StoredResult>& runs, const std::string& name) {
  const StoredResult& first = runs.front();
  StoredResult result;
  result.bench = first.bench;
  result.run = name;
  result.method = first.method;
  result.software = result.analysis_software = software_version();
  result.analysis_dds = "none";
  result.began_utc = first.began_utc;
  result.ended_utc = first.ended_utc;
  result.recipe = first.recipe;
  result.recipe_sha256 = first.recipe_sha256;
  result.sources = first.sources;
  result.roles = first.roles;
  result.corrections = first.corrections;
  result.check = first.check;
  result.conducted_by = first.conducted_by;
  result.conditions = conditions_of_all(runs);
  for (const StoredResult& run : runs) {
    if (run.check && !run.check->left_out.empty()) {
      result.check = run.check; // what documents must say
    }
    if (run.conducted_by != first.conducted_by) {
      result.conducted_by.reset(); // several did: their results name them
    }
    for (const std::string& sentence : amendment_sentences(run.journal)) {
      result.comment += fmt::format("Run {}: {}. ", run.run, sentence);
    }
    result.began_utc = std::min(result.began_utc, run.began_utc);
    result.ended_utc = std::max(result.ended_utc, run.ended_utc);
    result.combined.push_back({run.bench, run.run, run.sha256});
    for (const StoredFlag& flag : run.flags) {
      if (std::ranges::find(result.flags, flag.name, &StoredFlag::name) == result.flags.end()) {
        result.flags.push_back(flag);
      }
    }
  }
  return result;
}

void add_channel(const std::vector<StoredResult>& runs, const TransferFunction& function,
                 StoredResult& result) {
  StoredChannel channel;
  channel.channel = function.channel;
  channel.unit = function.unit;
  channel.responds = responds(function);
  channel.group_delay_problem = function.group_delay_problem;
  bool has_delay = function.group_delay.has_value();
  for (const StoredResult& run : runs) {
    const auto found = std::ranges::find(run.channels, function.channel, &StoredChannel::channel);
    if (found == run.channels.end()) {
      continue;
    }
    channel.lost += found->lost;
    add_once(found->flags, channel.flags);
    add_once(found->flag_names, channel.flag_names);
    std::ranges::copy(found->closures, std::back_inserter(channel.closures));
    if (found->group_delay_problem) {
      has_delay = false;
      channel.group_delay_problem = found->group_delay_problem;
    }
  }
  if (has_delay) {
    channel.group_delay_problem.reset();
    result.group_delays.push_back({function.channel, *function.group_delay});
  }
  result.channels.push_back(std::move(channel));
}

// The values of a channel, and what they are means of: a step for each mounting and point.
void add_points(const std::vector<StoredResult>& runs, const std::vector<StepResult>& mountings,
                const TransferFunction& function, StoredResult& result) {
  unsigned step = 0;
  for (const FrequencyPoint& point : function.points) {
    result.values.push_back(value_of(function, point));
    add_flags_of_runs(runs, result.values.back());
    for (const StepResult& one : mountings) {
      if (one.channel == function.channel && one.frequency_hz == point.frequency_hz &&
          one.level_m_s2 == point.level_m_s2) {
        result.points.push_back(stored_point(one, runs[one.repetition - 1]));
        result.points.back().step = ++step;
      }
    }
  }
  result.planned_steps = std::max(result.planned_steps, step);
}

} // namespace

Expected<StoredResult> combined_result(const std::vector<StoredResult>& runs,
                                       const std::string& name) {
  if (runs.size() < 2) {
    return fail(ErrorCode::bad_argument, "name at least two runs: one for each mounting");
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    DYNCAL_TRY(check_whole(runs[i]));
    for (std::size_t j = 0; j < i; ++j) {
      DYNCAL_TRY(check_same_measurement(runs[j], runs[i]));
    }
  }
  StoredResult result = head_of(runs, name);
  std::vector<StepResult> mountings;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (const StepResult& one :
         mounting_results(steps_of(runs[i]), static_cast<std::uint32_t>(i + 1))) {
      mountings.push_back(one);
    }
  }
  const auto functions = combined_functions(mountings, static_cast<std::uint32_t>(runs.size()));
  for (const TransferFunction& function : functions) {
    add_channel(runs, function, result);
    add_points(runs, mountings, function, result);
  }
  if (result.values.empty()) {
    return refuse(runs.front(), runs.back(), "they have no channel, frequency and level in common");
  }
  return result;
}

} // namespace dyncal::inline views
