// The sensor records a series after a trigger, and an oscilloscope records sync about it: series
// time stamping (series_step_evaluation.hpp).
//
// A step depends on the one before, for how the series of a sensor start shows in some steps only;
// so steps are evaluated in the caller's thread. The records of a step are kept until it is
// evaluated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "analysis/method/nominal_frequency.hpp"
#include "analysis/method/shared_bend.hpp"
#include "analysis/method/shared_start_scatter.hpp"
#include "analysis/method/start_latency.hpp"
#include "services/evaluation/method/method.hpp"
#include "services/evaluation/record/shot_record.hpp"

namespace dyncal::inline evaluation {

class SeriesTimeStamping : public Method {
public:
  using Method::Method;

  [[nodiscard]] std::vector<SearchedChannel> searches() const override;
  void add(const std::string& source, TriggeredRecord record) override;
  // All shots that were planned are there; or none can come any more, which has the same grace as
  // the samples of the ACS.
  [[nodiscard]] bool is_complete(std::size_t step, const RunRecords& records) const override;
  [[nodiscard]] Evaluation evaluation(std::size_t step, const RunRecords& records) override;
  [[nodiscard]] bool can_run_ahead() const override { return false; } // rates, kind of start
  // By how much the start may scatter, as all steps together tell, is in u of each; with a flag
  // where they show that it does. What changes within the series of most steps is flagged in all;
  // so is a drift of the clock that one step shows in those that do not exclude it.
  [[nodiscard]] bool settle(std::span<StepResult> results) const override;
  [[nodiscard]] std::vector<ClockReport> clock_reports() const override;

private:
  [[nodiscard]] std::vector<StepResult> evaluate(std::size_t step, const RunRecords& records);

  ShotRecord shots_;
  analysis::StartKind start_ = analysis::StartKind::undecided; // as far as the steps so far tell
  // By step of the recipe.
  std::map<std::size_t, analysis::StartEvidence> starts_;
  std::map<std::size_t, analysis::NominalFrequency> rates_;
  // By channel, then by number of the step.
  std::map<std::string, std::map<std::uint32_t, analysis::StepBend>> bends_;
};

} // namespace dyncal::inline evaluation
