// Follows one source through the planned steps: finds in its own clock where each step was excited,
// from its sync channel alone.
//
// With Recipe::whole_record nothing is searched: the one step is the record from its first to its
// last sample. Steps are searched in the order of their excitation (step_order.hpp), each from the
// end of the one before; the search never goes back but when the source was restarted. What it
// finds depends on the samples only, not on how they came.
//
// Where samples come before what was announced about them (`behind`), nobody says that a step was
// over without being found, and its repeat behind all others would be taken for it. Then a step was
// passed over when a later one, of another frequency, was excited before what shows of it.
//
// Where somebody has looked at the whole record before (`schedule`), a step is searched behind the
// excitation that was found before it, and only found where it was seen; one that the record lacks
// is passed over.
//
// Where the run is given up (`given_up`) it searches no further.
//
// Belongs to one thread; the record and the recipe must outlive it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <string>

#include "analysis/step/excitation_window.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/recorded_excitations.hpp"
#include "services/evaluation/record/run_schedule.hpp"
#include "services/evaluation/record/source_record.hpp"
#include "services/evaluation/record/step_order.hpp"
#include "services/evaluation/record/time_interval.hpp"

namespace dyncal::inline evaluation {

class StepSearch {
public:
  // `order` too outlives the search.
  StepSearch(const Recipe& recipe, const StepOrder& order, const SourceRecord& record,
             std::string sync_channel, bool behind = false,
             std::optional<RunSchedule::OfRecord> schedule = {}, std::stop_token given_up = {});

  // Looks at the samples that have come since the last call, as far as `last_step`.
  void advance(std::size_t last_step);

  // What to evaluate of the step: settling dropped, at most the planned duration; when settling is
  // found from the data, from the beginning of the excitation. While the excitation lasts this is
  // what is expected: empty until all of the planned duration has come, and later samples may
  // still change it (a step is found when step() has passed it).
  [[nodiscard]] std::optional<TimeInterval> interval(std::size_t step) const;
  // Of the step that has this interval: up to two seconds before its excitation began, a frame of
  // the search away from it and from the excitation before. Empty where there is no such time.
  [[nodiscard]] std::optional<TimeInterval> quiet_before(const TimeInterval& interval) const;
  // Of the same step: from a frame before its excitation began to its interval. Empty where the
  // record does not show how it began, and of the first step of a record of which nobody has seen
  // the whole: a stream and its recording do not begin at the same block.
  [[nodiscard]] std::optional<TimeInterval> rise_before(const TimeInterval& interval) const;
  // The first instant of interest for this step, quiet time before it included.
  [[nodiscard]] std::optional<std::int64_t> needed_for(std::size_t step) const;
  // Where the step was found; nothing for one that was not.
  [[nodiscard]] const FoundExcitation* excitation(std::size_t step) const;
  // Where the present session may show a step that was not found: between those that were.
  [[nodiscard]] TimeInterval where_missing(std::size_t step) const;
  // Of the source, that it was found in: in one session its clock goes on.
  [[nodiscard]] std::optional<std::uint32_t> session(std::size_t step) const;
  // Of the source now.
  [[nodiscard]] std::uint32_t present_session() const { return restarts_; }
  // What was found of the step is of a later one: this one, the record lacks. Those behind it are
  // searched once more.
  void pass_over(std::size_t step);
  // What was found of the step is an earlier excitation: it is searched behind that, and so are
  // those behind it. False, where the source was restarted since then.
  bool search_behind(std::size_t step);
  // Some step was found where the record begins: what is missing of it, the order does not tell.
  [[nodiscard]] bool begins_within_step() const;
  // The step whose excitation is searched now.
  [[nodiscard]] std::size_t step() const { return step_; }
  // Nothing comes any more in the source's present session, of which all was looked at: a step that
  // is expected is found.
  void end_session();
  // Takes what there is of the step searched, or passes over it when there is nothing; the search
  // goes on with the next.
  void give_up_step();
  // Nothing earlier than this is needed for steps that were not found yet.
  [[nodiscard]] std::int64_t needed_from_ns() const { return search_from_ns_; }

private:
  struct Found {
    TimeInterval interval;
    std::optional<TimeInterval> quiet{};
    std::optional<TimeInterval> rise{};
    FoundExcitation excitation{};
    std::int64_t searched_from_ns = 0;
    std::uint32_t session = 0;
  };

  void search_step(std::size_t step);
  void take_whole_record(bool complete);
  void feed();
  void expect();
  void accept(const analysis::ExcitationWindow& window);
  [[nodiscard]] bool was_passed_over(const analysis::ExcitationWindow& window);
  [[nodiscard]] bool shows_before(std::size_t step, std::int64_t end_ns) const;
  // Nothing was scheduled, or this: where it was seen.
  [[nodiscard]] const std::optional<ScheduledStep>* scheduled(std::size_t step) const;
  [[nodiscard]] TimeInterval evaluated_part(const analysis::ExcitationWindow& window) const;
  [[nodiscard]] std::optional<TimeInterval>
  quiet_time(const analysis::ExcitationWindow& window) const;
  [[nodiscard]] std::optional<TimeInterval> rise(const analysis::ExcitationWindow& window,
                                                 const TimeInterval& evaluated) const;
  [[nodiscard]] Found found(const analysis::ExcitationWindow& window) const;
  [[nodiscard]] const Found* with_interval(const TimeInterval& interval) const;

  const Recipe& recipe_;
  const StepOrder& order_;
  const SourceRecord& record_;
  std::string sync_channel_;
  bool behind_;
  std::optional<RunSchedule::OfRecord> schedule_;
  std::stop_token given_up_;
  std::uint32_t restarts_ = 0;
  std::size_t step_ = 0;
  std::int64_t search_from_ns_;
  std::optional<std::int64_t> record_begin_ns_; // its first stamp
  std::uint64_t fed_ = 0; // samples of the record, counted from its very first
  std::optional<analysis::ExcitationWindowFinder> finder_;
  std::map<std::size_t, Found> found_;
  std::optional<std::int64_t> in_place_; // beginning of a window that no later step is before
  std::optional<Found> expected_;        // of the step that is searched
  std::int64_t expected_until_ns_; // newest stamp up to which this need not be looked at again
};

} // namespace dyncal::inline evaluation
