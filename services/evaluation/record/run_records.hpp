// All that the sources of one run have sent, and where in it the steps are.
//
// One record a source, and one search for the steps in each channel that the method names: the
// channel of the ACS first. Steps are places in the order of their excitation (step_order.hpp).
// Samples that no step needs any more are forgotten. Belongs to one thread; the recipe must outlive
// it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/announced_instants.hpp"
#include "services/evaluation/record/compared_excitations.hpp"
#include "services/evaluation/record/excitation_progress.hpp"
#include "services/evaluation/record/run_schedule.hpp"
#include "services/evaluation/record/source_record.hpp"
#include "services/evaluation/record/time_interval.hpp"

namespace dyncal::inline evaluation {

// A channel that steps are found in, and the sources whose samples are selected by what it finds.
struct SearchedChannel {
  ChannelName channel;
  std::vector<std::string> sources;
};

// The samples of one source in one step, those from before it, where nothing was excited, and those
// of how its excitation began: empty where none are known. Passes into another thread when it holds
// copies.
struct SourceInterval {
  std::shared_ptr<const SourceRecord> record;
  TimeInterval interval;
  std::shared_ptr<const SourceRecord> quiet_record{};
  TimeInterval quiet{};
  std::shared_ptr<const SourceRecord> rise_record{};
  TimeInterval rise{};
};

class RunRecords {
public:
  // `capacity`: samples that a source's record holds. `behind`, `schedule`, `given_up`:
  // step_search.hpp.
  RunRecords(const Recipe& recipe, const std::vector<SearchedChannel>& searched,
             std::size_t capacity = SourceRecord::default_capacity, bool behind = false,
             std::shared_ptr<const RunSchedule> schedule = nullptr, std::stop_token given_up = {});
  RunRecords(const RunRecords&) = delete; // its searches look at it
  RunRecords& operator=(const RunRecords&) = delete;

  [[nodiscard]] ExcitationProgress& excitation() { return excitation_; }
  // `heard_ns`: by the clock of those times of blocks; without them the newest stamps tell what
  // time it is in a source.
  void announce(const StepAnnouncement& announcement, std::optional<std::int64_t> heard_ns = {});
  // Nobody wants anything of this run any more.
  [[nodiscard]] const std::stop_token& given_up() const { return given_up_; }
  // Of every block of a source.
  void note_times(const std::string& source, const SourceBlock& block, const BlockTimes& times) {
    instants_.add(source, block, times);
  }
  // The records may lack the begin of the run, which nobody saw.
  void may_begin_late(bool may) { compared_.may_begin_late(may); }
  [[nodiscard]] const ExcitationProgress& excitation() const { return excitation_; }
  [[nodiscard]] const RecipeStep& planned(std::size_t step) const {
    return excitation_.order().step(step);
  }

  [[nodiscard]] std::vector<std::string> sources() const;
  // Null for a source that is not of the run.
  [[nodiscard]] SourceRecord* find(const std::string& source);
  // REQUIRES: a source of the run.
  [[nodiscard]] const SourceRecord& of(const std::string& source) const;
  // Sources that have not described themselves yet.
  [[nodiscard]] std::vector<std::string> undescribed() const;

  // Whether nothing of the step can come from the source any more: it has gone on for `grace` since
  // the step was announced to be over, both by its own time, as well as that instant is known in it
  // (announced_instants.hpp), and by when its blocks were heard. Where a host's clock was set, that
  // instant is at most `longest_delay` behind what had come.
  [[nodiscard]] bool is_over_in(const std::string& source, std::size_t step) const;
  static constexpr std::chrono::nanoseconds grace = std::chrono::seconds(5);
  static constexpr std::chrono::nanoseconds longest_delay = std::chrono::seconds(60);

  // The source is about to begin a new session, which drops what its record holds: steps of which
  // all planned samples have come count as found. Returns whether it holds such a step that is not
  // evaluated yet, from `next_step` on.
  [[nodiscard]] bool end_session(const std::string& source, std::size_t next_step);

  // Searches the samples that have come since the last call for steps before `end_step`, in a
  // conducted run for those that were announced; passes over steps that are over in the source and
  // show nothing.
  void search(std::size_t end_step = std::numeric_limits<std::size_t>::max());
  // Every search has passed the step.
  [[nodiscard]] bool is_searched(std::size_t step) const { return compared_.is_searched(step); }
  // Every search has passed the step, or knows what it will be if nothing unexpected comes
  // (step_search.hpp).
  [[nodiscard]] bool is_expected(std::size_t step) const;
  // Of the step in the clock of one search, in the order of the channels given.
  [[nodiscard]] std::optional<TimeInterval> interval(std::size_t search, std::size_t step) const;

  // compared_excitations.hpp. REQUIRES: all of the records was searched.
  [[nodiscard]] bool agree_with_plan() const { return compared_.agree_with_plan(); }
  // Why a step has no value, where somebody has looked for it before (run_schedule.hpp).
  [[nodiscard]] std::string why_missing(std::size_t step) const;
  // compared_excitations.hpp
  [[nodiscard]] std::string when_missing(std::size_t step, const std::string& channel) const {
    return compared_.when_missing(step, channel);
  }
  // Where in its clock a source may show a step that was not found: between those that were.
  [[nodiscard]] TimeInterval where_missing(const std::string& source, std::size_t step) const;
  // The step was announced to be over before the first sample of the source.
  [[nodiscard]] bool began_after(const std::string& source, std::size_t step) const;
  // Or behind its last one, so far.
  [[nodiscard]] bool ended_before(const std::string& source, std::size_t step) const;
  // What was found of it may as well be another step of its frequency and level.
  [[nodiscard]] bool is_uncertain(std::size_t step) const;

  // Evaluated in the caller's thread these look at the records themselves, else at copies.
  void copy_samples(bool copies) { copies_ = copies; }
  // Of the step in a source; nothing where no search applies to it or the step was not found.
  [[nodiscard]] std::optional<TimeInterval> interval_in(const std::string& source,
                                                        std::size_t step) const;
  [[nodiscard]] SourceInterval samples(const std::string& source,
                                       const TimeInterval& interval) const;

  // Steps before `next_step` have been evaluated.
  void forget_before_step(std::size_t next_step);

private:
  void note_newest_stamps();
  // That selects the samples of the source; none: the end.
  [[nodiscard]] std::vector<ChannelSearch>::const_iterator
  search_of(const std::string& source) const;
  [[nodiscard]] std::size_t steps_searched() const;
  void search_all(std::size_t expected);
  void search_one(ChannelSearch& search, std::size_t expected) const;
  [[nodiscard]] std::shared_ptr<const SourceRecord> part_of(const SourceRecord& whole,
                                                            const TimeInterval& interval) const;
  void follow_restarts();

  ExcitationProgress excitation_;
  bool behind_; // samples come before what was announced about them
  std::shared_ptr<const RunSchedule> schedule_;
  std::stop_token given_up_;
  std::map<std::string, std::unique_ptr<SourceRecord>> records_;
  AnnouncedInstants instants_;
  std::map<std::string, std::uint32_t> followed_; // session of a source, once it has sent samples
  std::vector<ChannelSearch> searches_;
  ComparedExcitations compared_;
  bool copies_ = false;
};

} // namespace dyncal::inline evaluation
