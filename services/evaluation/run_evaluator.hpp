// The evaluation of one run, whoever brings the samples: the analysis service from DDS, `dyncal
// analyse` from files.
//
// Fed with descriptions, blocks and announcements in any order of arrival between sources; gives
// results as soon as the samples of a step have come from every source, and the run's transfer
// functions and sample clock report at its end. A step is given up, with a result that says why,
// when its excitation was announced as over and two seconds of later samples show nothing of it in
// a source, when a source has ended without it, or when the run is over. The same samples give the
// same results bit for bit. Belongs to one thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "idl/dyncal.h"
#include "services/error.hpp"
#include "services/evaluation/clock_report.hpp"
#include "services/evaluation/evaluation_queue.hpp"
#include "services/evaluation/method/apart_step_evaluation.hpp"
#include "services/evaluation/method/series_step_evaluation.hpp"
#include "services/evaluation/method/shot_record.hpp"
#include "services/evaluation/recipe.hpp"
#include "services/evaluation/source_record.hpp"
#include "services/evaluation/step_search.hpp"
#include "services/evaluation/transfer_summary.hpp"

namespace dyncal::services {

struct EvaluationOutput {
  std::vector<wire::CalibrationResult> results;
  std::vector<wire::TransferFunction> transfer_functions; // at the end of the run
  std::vector<wire::SampleClockReport> clock_reports;     // at the end of the run
};

class RunEvaluator {
public:
  // `evaluations_at_once` > 0: so many steps are evaluated in threads of their own, from copies of
  // their samples, while this one goes on to take samples; 0: in this one. The results are the
  // same.
  explicit RunEvaluator(Recipe recipe, std::size_t evaluations_at_once = 0);
  ~RunEvaluator();
  RunEvaluator(const RunEvaluator&) = delete;
  RunEvaluator& operator=(const RunEvaluator&) = delete;

  [[nodiscard]] const Recipe& recipe() const { return recipe_; }

  // Fails (no_source) with the channels there are when the source lacks one that the recipe needs.
  Expected<void> describe(const wire::SourceDescription& description);
  // Sources of the recipe that have not described themselves yet.
  [[nodiscard]] std::vector<std::string> undescribed() const;

  void add(const wire::SampleBlock& block);
  // Series time stamping: of the oscilloscope or of the sensor, by its source.
  void add(const wire::TriggeredRecord& record);
  void announce(const wire::Excitation& excitation);
  // No excitation comes any more: the run is done, or was broken off after the steps announced so
  // far.
  void end_of_excitation(bool aborted);

  // Evaluates what can be evaluated and hands over what is new.
  [[nodiscard]] EvaluationOutput take_output();
  // Everything of this run has been handed over.
  [[nodiscard]] bool finished() const { return finished_; }
  // Ends the run with what there is, whatever is still missing.
  void finish_now();

private:
  [[nodiscard]] SourceRecord* record(const std::string& source);
  [[nodiscard]] std::size_t steps_expected() const;
  [[nodiscard]] bool over_in(const SourceRecord& source, std::size_t step) const;
  void follow(StepSearch& search, const SourceRecord& source);
  void evaluate_next_steps(EvaluationOutput& output);
  [[nodiscard]] bool by_series() const {
    return recipe_.method == wire::METHOD_SERIES_TIMESTAMPING;
  }
  [[nodiscard]] bool by_absolute_time() const {
    return recipe_.method == wire::METHOD_ABSOLUTE_TIME;
  }
  [[nodiscard]] bool ready_to_evaluate(std::size_t step) const;
  [[nodiscard]] bool shots_are_there(std::size_t step) const;
  // Sensors with stamps of their own: whether the samples of the step's stretch have come.
  [[nodiscard]] bool sensors_are_there(std::size_t step) const;
  // Which search finds the sensors' stretches.
  [[nodiscard]] const StepSearch& search_of_sensors() const {
    return recipe_.without_sync() ? *acs_search_ : *dau_search_;
  }
  [[nodiscard]] std::vector<ChannelName> channels_needed() const;
  void keep_only_what_is_needed(SourceRecord& source) const;
  void take_results(std::vector<wire::CalibrationResult> results, EvaluationOutput& output);
  // The next step by its method. What is evaluated in another thread looks at nothing that changes.
  [[nodiscard]] EvaluationQueue::Evaluation evaluation_by_method(const RecipeStep& step);
  [[nodiscard]] EvaluationQueue::Evaluation analogue_evaluation(const RecipeStep& step) const;
  [[nodiscard]] EvaluationQueue::Evaluation stamped_evaluation(const RecipeStep& step) const;
  [[nodiscard]] EvaluationQueue::Evaluation apart_evaluation(const RecipeStep& step) const;
  [[nodiscard]] std::vector<wire::CalibrationResult>
  evaluate_triggered_step(const RecipeStep& step);
  // The source's record, or a copy of that part of it when it is evaluated in another thread.
  [[nodiscard]] std::shared_ptr<const SourceRecord> samples_of(const std::string& source,
                                                               const StretchOfTime& stretch) const;
  void forget_what_is_evaluated();
  void finish(EvaluationOutput& output);

  Recipe recipe_;
  std::map<std::string, std::unique_ptr<SourceRecord>> records_;
  std::unique_ptr<StepSearch> acs_search_;
  std::unique_ptr<StepSearch> dau_search_;
  ClockReportBuilder clock_;
  TransferSummary summary_;
  std::size_t next_step_ = 0; // not evaluated yet
  std::map<std::size_t, std::int64_t>
      over_utc_ns_; // host time at which the excitation of a step was over
  ShotRecord shots_;
  analysis::StartKind start_ =
      analysis::StartKind::undecided;             // of the series, as far as the steps so far tell
  std::vector<analysis::NominalFrequency> rates_; // of the sensor, one a step
  std::set<std::size_t> broken_off_;              // steps whose excitation was aborted
  std::size_t steps_announced_ = 0;
  bool excitation_done_ = false;
  bool excitation_aborted_ = false;
  bool finish_now_ = false;
  bool finished_ = false;
  EvaluationQueue evaluations_; // the last member, for it waits for those that look at the others
};

} // namespace dyncal::services
