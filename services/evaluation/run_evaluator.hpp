// The evaluation of one run, whoever brings the samples: the analysis service from DDS, `dyncal
// analyse` from files.
//
// Fed with descriptions, blocks and announcements in any order of arrival between sources; gives
// results as soon as the samples of a step have come from every source, and the run's transfer
// functions and sample clock report at its end. A step is given up, with a result that names the
// reason, when its excitation was announced as over and later samples show nothing of it in a
// source (run_records.hpp), when a source has ended without it, or when the run is over. The same
// samples give the same results bit for bit.
//
// A result beside a mains line, or with a harmonic folded onto it, is provisional and flagged until
// the end of the run, when all steps tell how large that line may be (line_bounds.hpp). Where they
// show something else at its frequency, its u grows then, although it was not provisional. So does
// u where the method finds what only all steps together show (Method::settle).
//
// A step may be excited again after the planned ones, as announced: it is searched behind all that
// was found, and its results take the place of those before. Where steps are announced at all, the
// run therefore ends with end_of_excitation() only; records that nobody conducts end with the last
// planned step.
//
// Live (`ahead`) a step is evaluated as soon as its planned samples have come, while it is still
// excited; its end then only confirms what was expected, and the result is handed over at once,
// before anything else is done: take again at once what came out with results. An excitation that
// ends sooner, or samples that change the step afterwards, are evaluated when the step has ended,
// as without it.
//
// What depends on the method is asked of it (method/method.hpp). Belongs to one thread.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/base/work_count.hpp"
#include "services/evaluation/channel_faults.hpp"
#include "services/evaluation/clock_report_builder.hpp"
#include "services/evaluation/evaluation_queue.hpp"
#include "services/evaluation/level_watch.hpp"
#include "services/evaluation/line_bounds.hpp"
#include "services/evaluation/method/method.hpp"
#include "services/evaluation/rate_watch.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/run_records.hpp"
#include "services/evaluation/record/step_snapshot.hpp"
#include "services/evaluation/transfer_summary.hpp"

namespace dyncal::inline evaluation {

struct EvaluationOutput {
  std::vector<StepResult> results;
  std::vector<TransferFunction> transfer_functions; // at the end of the run
  std::vector<ClockReport> clock_reports;           // at the end of the run
  // At the end of the run: those that were provisional, and those in whose background the other
  // steps found something; to take the place of what was handed over with the same channel, step
  // and repetition.
  std::vector<StepResult> settled;
};

struct EvaluationLimits {
  // So many steps are evaluated in threads of their own, from copies of their samples, while the
  // caller's goes on to take samples; 0: in the caller's. The results are the same.
  std::size_t evaluations_at_once = 0;
  // The caller never waits for those, nor for what all steps together tell: the next step begins
  // when there is room, and a later call of take_output() hands over the end of the run, which is
  // made in a thread of its own.
  bool never_waits = false;
  std::size_t samples_of_a_source = SourceRecord::default_capacity; // held; see source_record.hpp
  // The sample clock is followed to the end of its source, not only to the last step: for records
  // that are there already.
  bool clock_to_the_end = false;
  // With that: it is followed to this block and no further, as a report made before covers it.
  std::optional<BlockPosition> clock_end{};
  SharedWorkCount count{}; // of steps, then of results that the last step settles
  bool ahead = false;      // in the caller's thread only: before the end of a step has come
  // The run began before: its samples come before what was announced about them (step_search.hpp).
  bool behind = false;
  // A source may lack the begin of the run, which nobody saw: recordings.
  bool may_begin_late = false;
  // Where the steps are, from somebody who has looked at the whole records (step_survey.hpp).
  std::shared_ptr<const RunSchedule> schedule{};
};

class RunEvaluator {
public:
  explicit RunEvaluator(Recipe recipe, const EvaluationLimits& limits = {});
  ~RunEvaluator();
  RunEvaluator(const RunEvaluator&) = delete;
  RunEvaluator& operator=(const RunEvaluator&) = delete;

  [[nodiscard]] const Recipe& recipe() const { return *recipe_; }

  // Fails (no_source) with the channels there are when the source lacks one that the recipe needs,
  // when a role has a channel of another quantity (contract/role_quantities.hpp), when a planned
  // frequency is not below half its sample rate, and when its time scale does not fit those of
  // others. Then the run goes on by the description that was accepted before, if any.
  Expected<void> describe(const std::string& source, drivers::SourceDescription description);
  // The source tells anew of which quadrature signals it makes a displacement, within its session:
  // its samples mean what they meant, and steps from now on have this uncertainty.
  void describe_signals(const std::string& source, std::vector<drivers::QuadratureSignals> signals);
  // Sources of the recipe that have not described themselves yet.
  [[nodiscard]] std::vector<std::string> undescribed() const { return records_.undescribed(); }

  // `times`: where they are known, they tell which step a source shows that begins late
  // (record/announced_instants.hpp).
  void add(const std::string& source, const SourceBlock& block,
           const std::optional<BlockTimes>& times = {});
  // A block of this source came from another program than those before it, and is not added.
  void note_second_writer(const std::string& source);
  // Whether a block of this session may be added without the loss of a step that has come but
  // cannot be evaluated yet, because another source is behind: a new session drops what is held.
  // It is for the caller to wait with the block, and for how long.
  [[nodiscard]] bool is_ready_for(const std::string& source, std::uint64_t session);
  // Of an instrument that records after a trigger, by its source.
  void add(const std::string& source, TriggeredRecord record);
  // Of a system that evaluates itself; passes over steps of any other source.
  void add(const std::string& source, ReferenceStep step);
  // `heard_ns`: by the clock of the times of blocks.
  void announce(const StepAnnouncement& announcement, std::optional<std::int64_t> heard_ns = {});
  // Steps are announced in this run, although what was announced may come later.
  void expect_announcements() { records_.excitation().expect_announcements(); }
  // No excitation comes any more: the run is done, or was broken off after the steps announced so
  // far.
  void end_of_excitation(bool aborted);

  // One sentence when the step that is excited now is driven far above its planned level
  // (level_watch.hpp): whoever conducts the run must end the excitation.
  [[nodiscard]] std::optional<std::string> excess_of_level();
  // One sentence when a source turns out to sample too slowly for a planned step (rate_watch.hpp):
  // no repetition of the step changes that.
  [[nodiscard]] const std::optional<std::string>& too_slow_source() const {
    return rate_watch_.problem();
  }

  // Evaluates what can be evaluated and hands over what is new.
  [[nodiscard]] EvaluationOutput take_output();
  // The source whose sample clock is followed although every step has been evaluated; nothing as
  // long as steps are missing. Samples of other sources have no use any more.
  [[nodiscard]] std::optional<std::string> source_of_clock_alone() const;
  // Steps whose results were there when their end was found (`ahead`).
  [[nodiscard]] std::size_t steps_ready() const { return steps_ready_; }
  // Steps are being evaluated, or the end of the run is made, in threads of their own.
  [[nodiscard]] bool is_evaluating() const;
  // The run takes nothing more: its end is made, or was handed over.
  [[nodiscard]] bool is_ending() const { return ending_.valid() || finished_; }
  // Every planned step has been evaluated; some may be excited again.
  [[nodiscard]] bool has_planned_steps() const { return next_step_ >= recipe_->excitations(); }
  // Every planned step was found in the records, or passed over there.
  [[nodiscard]] bool has_found_planned_steps() const {
    return records_.is_searched(recipe_->excitations() - 1);
  }
  // Nobody conducts this run, and its records do not show all planned steps one after the other, or
  // not the same ones: whether each was taken for the right one, only a survey of all that they
  // show can tell (step_survey.hpp). REQUIRES: finished()
  [[nodiscard]] bool needs_survey() const;
  // Everything of this run has been handed over.
  [[nodiscard]] bool finished() const { return finished_; }
  // Ends the run with what there is, whatever is still missing.
  void finish_now();
  // Monte Carlo checks under way, and those of what is still evaluated, end at once: their results
  // have a flag instead.
  void stop_checks() { evaluations_.stop(); }
  // Nobody wants anything of this run any more. No step is searched or evaluated from now on, those
  // under way end between two of their channels, and take_output() hands nothing over; a run that
  // is not finished stays so. From any thread.
  void give_up();
  [[nodiscard]] bool is_given_up() const { return given_up_.stop_requested(); }

private:
  [[nodiscard]] bool is_evaluated(const TriggeredRecord& record) const;
  [[nodiscard]] bool has_all_steps() const;
  // Returns false if steps that could be evaluated wait for room.
  bool evaluate_next_steps(EvaluationOutput& output);
  [[nodiscard]] Evaluation evaluation_of_next_step();
  [[nodiscard]] Evaluation completed(Evaluation evaluation) const;
  void evaluate_ahead();
  void keep(const StepResult& result);
  void take_results(std::vector<StepResult> results, EvaluationOutput& output);
  [[nodiscard]] std::vector<StepResult> settled_results();
  [[nodiscard]] EvaluationOutput end_of_run();
  void follow_clock(const SourceRecord& record, const SourceBlock& block);
  void finish(EvaluationOutput& output);
  void close(EvaluationOutput& output) const;
  [[nodiscard]] std::string reference_unit() const;

  std::shared_ptr<const Recipe> recipe_;
  std::stop_source given_up_;
  std::unique_ptr<Method> method_;
  RunRecords records_;
  std::optional<ClockReportBuilder> clock_;
  LevelWatch level_watch_;
  RateWatch rate_watch_;
  TransferSummary summary_;
  LineBounds line_bounds_;
  ChannelFaults channel_faults_;
  std::vector<StepResult> results_; // that the end of the run may settle
  struct AheadOfEnd {               // the next step as it is expected to be
    StepSnapshot inputs;
    std::vector<StepResult> results;
  };

  bool runs_ahead_;
  std::optional<AheadOfEnd> ahead_;
  std::size_t steps_ready_ = 0;
  std::size_t next_step_ = 0; // not evaluated yet
  bool clock_to_the_end_;
  std::optional<BlockPosition> clock_end_;
  std::optional<std::uint64_t> lost_at_clock_end_; // once that block has come
  bool never_waits_;
  SharedWorkCount count_;
  bool finished_ = false;
  // The last members: they end what looks at the others.
  EvaluationQueue evaluations_;
  std::future<EvaluationOutput> ending_; // from the last step on
};

} // namespace dyncal::inline evaluation
