#include "services/evaluation/record/step_alignment.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "analysis/base/statistics.hpp"
#include "services/evaluation/record/cut_step.hpp"
#include "services/evaluation/record/excitation_pairs.hpp"
#include "services/evaluation/record/missing_step.hpp"
#include "services/evaluation/record/step_places.hpp"

namespace dyncal::inline evaluation {
namespace {

using Plan = std::span<const RecipeStep* const>;

struct StepsInRecords {
  std::vector<JoinedExcitation> shown; // by step; neither: it shows nowhere
  std::vector<bool> uncertain;         // by step
};

// Of a pause: what stays within it is cut out of it.
constexpr double whole_pause = 0.7;
constexpr std::int64_t shortest_ns =
    250'000'000; // of what can be evaluated (excitation_window.hpp)

// By excitation its only place in the plan; nothing where there are several for one, or none.
std::optional<std::vector<std::size_t>> only_places(Plan plan,
                                                    const std::vector<FoundExcitation>& found) {
  // In the first place that is free from the front, and in the last one from the back.
  std::vector<std::size_t> first, last(found.size());
  std::size_t step = 0;
  for (const FoundExcitation& one : found) {
    while (step < plan.size() && !could_be(one, *plan[step])) {
      ++step;
    }
    if (step == plan.size()) {
      return std::nullopt;
    }
    first.push_back(step++);
  }
  step = plan.size();
  for (std::size_t i = found.size(); i-- > 0;) {
    while (step > 0 && !could_be(found[i], *plan[step - 1])) {
      --step;
    }
    last[i] = --step; // there is one: `first` has found it
  }
  return first == last ? std::optional(first) : std::nullopt;
}

std::optional<StepsInRecords> by_frequency(Plan plan,
                                           const std::vector<RecordedExcitations>& records) {
  StepsInRecords steps{std::vector<JoinedExcitation>(plan.size()), std::vector<bool>(plan.size())};
  for (std::size_t record = 0; record < records.size(); ++record) {
    const auto places = only_places(plan, records[record].found);
    if (!places) {
      return std::nullopt;
    }
    for (std::size_t i = 0; i < places->size(); ++i) {
      JoinedExcitation& step = steps.shown[(*places)[i]];
      (record == 0 ? step.first : step.second) = i;
    }
  }
  return steps;
}

std::optional<std::vector<JoinedExcitation>>
joined(Plan plan, const std::vector<RecordedExcitations>& records) {
  if (records.size() == 2 && !records[0].found.empty() && !records[1].found.empty()) {
    return join_excitations(plan, records[0], records[1]);
  }
  std::vector<JoinedExcitation> alone;
  for (std::size_t i = 0; i < records[0].found.size(); ++i) {
    alone.push_back({.first = i});
  }
  for (std::size_t i = 0; alone.empty() && i < records.back().found.size(); ++i) {
    alone.push_back({.second = i});
  }
  return alone;
}

// Its first pause was cut, and its last was not.
bool begins_late(const RecordedExcitations& record) {
  std::vector<std::int64_t> pauses;
  for (std::size_t i = 1; i < record.found.size(); ++i) {
    pauses.push_back(record.found[i].begin_ns() - record.found[i - 1].end_ns());
  }
  if (pauses.empty()) {
    return false;
  }
  const double whole_ns =
      whole_pause * static_cast<double>(analysis::upper_median(std::span<std::int64_t>(pauses)));
  const auto is_whole = [&](std::int64_t from_ns, std::int64_t to_ns) {
    return static_cast<double>(to_ns - from_ns) > whole_ns;
  };
  return !is_whole(record.recorded.begin_ns, record.found.front().begin_ns()) &&
         is_whole(record.found.back().end_ns(), record.recorded.end_ns);
}

StepsInRecords placed(Plan plan, const std::vector<RecordedExcitations>& records,
                      const std::vector<JoinedExcitation>& joined) {
  const auto in_both = std::ranges::find_if(
      joined, [](const JoinedExcitation& one) { return one.first && one.second; });
  const std::int64_t offset_ns = in_both == joined.end()
                                     ? 0
                                     : records[1].found[*in_both->second].begin_ns() -
                                           records[0].found[*in_both->first].begin_ns();
  std::vector<ExcitationInRun> excitations;
  for (const JoinedExcitation& one : joined) {
    const FoundExcitation& shown =
        one.first ? records[0].found[*one.first] : records[1].found[*one.second];
    excitations.push_back({&shown, shown.begin_ns() - (one.first ? 0 : offset_ns),
                           records.size() == 1 || (one.first && one.second)});
  }
  const bool late = std::ranges::all_of(records, begins_late);
  const auto places = place_excitations(plan, excitations, late);
  const auto other_way = place_excitations(plan, excitations, !late);
  StepsInRecords steps{std::vector<JoinedExcitation>(plan.size()), std::vector<bool>(plan.size())};
  for (std::size_t i = 0; i < joined.size(); ++i) {
    if (places[i]) {
      steps.shown[*places[i]] = joined[i];
      steps.uncertain[*places[i]] = places[i] != other_way[i];
    }
  }
  return steps;
}

std::optional<ScheduledStep> scheduled(const RecordedExcitations& record,
                                       std::optional<std::size_t> place) {
  if (!place) {
    return std::nullopt;
  }
  const FoundExcitation& one = record.found[*place];
  return ScheduledStep{one.search_from_ns, {one.begin_ns(), one.end_ns()}};
}

// In `record`, one of the two: the step within which it begins.
void cut(Plan plan, const RecordedExcitations& record,
         std::optional<std::size_t> JoinedExcitation::*place,
         const std::vector<JoinedExcitation>& steps, RunSchedule::OfRecord& scheduled,
         std::vector<std::string>& problems) {
  std::vector<const RecipeStep*> of_excitation(record.found.size());
  std::size_t first = plan.size();
  for (std::size_t step = 0; step < plan.size(); ++step) {
    if (const auto& found = steps[step].*place) {
      of_excitation[*found] = plan[step];
      first = *found == 0 ? step : first;
    }
  }
  if (first == plan.size()) {
    return;
  }
  const auto evaluated = evaluated_of_cut_step(record, of_excitation);
  if (!evaluated) {
    return;
  }
  if (evaluated->end_ns - evaluated->begin_ns < shortest_ns) {
    scheduled[first].reset();
    problems[first] = fmt::format("no steady sine of {} Hz was found in {}: the record of '{}' "
                                  "begins at the end of this step",
                                  plan[first]->frequency_text_hz, record.channel, record.source);
    return;
  }
  scheduled[first]->evaluated = *evaluated;
}

std::string nothing_tells(const std::vector<RecordedExcitations>& records) {
  return fmt::format("{} shows {} steps and {} shows {}, and nothing tells which of them are the "
                     "same: neither their frequencies nor their instants; begin both records "
                     "before the first step and end them after the last one",
                     records[0].channel, records[0].found.size(), records[1].channel,
                     records[1].found.size());
}

} // namespace

RunSchedule align_steps(Plan plan, const std::vector<RecordedExcitations>& records) {
  RunSchedule schedule;
  schedule.problems.resize(plan.size());
  schedule.records.assign(records.size(), RunSchedule::OfRecord(plan.size()));
  auto steps = by_frequency(plan, records);
  if (!steps) {
    const auto in_order = joined(plan, records);
    if (!in_order) {
      std::ranges::fill(schedule.problems, nothing_tells(records));
      return schedule;
    }
    steps = placed(plan, records, *in_order);
  }
  const std::vector<JoinedExcitation>& shown = steps->shown;
  schedule.uncertain = steps->uncertain;
  for (std::size_t step = 0; step < plan.size(); ++step) {
    schedule.records[0][step] = scheduled(records[0], shown[step].first);
    if (records.size() == 2) {
      schedule.records[1][step] = scheduled(records[1], shown[step].second);
    }
    schedule.problems[step] = why_missing(plan, records, shown, step);
  }
  cut(plan, records[0], &JoinedExcitation::first, shown, schedule.records[0], schedule.problems);
  if (records.size() == 2) {
    cut(plan, records[1], &JoinedExcitation::second, shown, schedule.records[1], schedule.problems);
  }
  return schedule;
}

} // namespace dyncal::inline evaluation
