// Looks at all that the records of a run show before its steps are evaluated, where they do not
// show all planned steps one after the other: one begins late, lacks a step, or holds one that
// nobody planned. Then the order alone would join one step with another
// (record/step_alignment.hpp).
//
// Takes the same blocks as the evaluation, whose steps it schedules then. Sources in which no steps
// are searched are passed over. Belongs to one thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/sample_block.hpp"
#include "services/contract/source_block.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/excitation_survey.hpp"
#include "services/evaluation/record/run_schedule.hpp"

namespace dyncal::inline evaluation {

class StepSurvey {
public:
  explicit StepSurvey(const Recipe& recipe);

  // Whether steps are searched in it.
  [[nodiscard]] bool looks_at(const std::string& source) const;
  // REQUIRES: the source has the recipe's channels (RunEvaluator::describe()).
  void describe(const std::string& source, const drivers::SourceDescription& description);
  void add(const std::string& source, const SourceBlock& block);

  // After the last block of every source.
  [[nodiscard]] std::shared_ptr<const RunSchedule> schedule() const;

private:
  const Recipe& recipe_;
  std::vector<ExcitationSurvey> records_; // in the order of the method's searches
};

} // namespace dyncal::inline evaluation
