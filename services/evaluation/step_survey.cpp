#include "services/evaluation/step_survey.hpp"

#include <algorithm>
#include <optional>

#include "services/evaluation/method/method.hpp"
#include "services/evaluation/record/step_alignment.hpp"
#include "services/evaluation/record/step_order.hpp"

namespace dyncal::inline evaluation {

StepSurvey::StepSurvey(const Recipe& recipe) : recipe_(recipe) {
  const auto method = make_method(std::make_shared<const Recipe>(recipe));
  for (const SearchedChannel& searched : method->searches()) {
    const bool has_reference = recipe.reference().source == searched.channel.source;
    records_.emplace_back(searched.channel,
                          has_reference ? std::optional(recipe.reference().channel) : std::nullopt,
                          recipe);
  }
}

bool StepSurvey::looks_at(const std::string& source) const {
  return std::any_of(records_.begin(), records_.end(),
                     [&](const ExcitationSurvey& one) { return one.source() == source; });
}

void StepSurvey::describe(const std::string& source,
                          const drivers::SourceDescription& description) {
  for (ExcitationSurvey& one : records_) {
    if (one.source() == source) {
      one.describe(description);
    }
  }
}

void StepSurvey::add(const std::string& source, const SourceBlock& block) {
  for (ExcitationSurvey& one : records_) {
    if (one.source() == source) {
      one.add(block);
    }
  }
}

std::shared_ptr<const RunSchedule> StepSurvey::schedule() const {
  std::vector<const RecipeStep*> plan;
  const StepOrder order(recipe_);
  for (std::size_t place = 0; place < order.size(); ++place) {
    plan.push_back(&order.step(place));
  }
  std::vector<RecordedExcitations> found;
  for (const ExcitationSurvey& one : records_) {
    found.push_back(one.result());
  }
  return std::make_shared<const RunSchedule>(align_steps(plan, found));
}

} // namespace dyncal::inline evaluation
