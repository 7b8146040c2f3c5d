// What methods have in common whose sensor is stamped by the DAU that records sync: steps are found
// in sync of both clocks, and are evaluated from the samples of ACS and DAU. One thread, as
// method.hpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/evaluation/method/method.hpp"
#include "services/evaluation/method/step_task.hpp"

namespace dyncal::inline evaluation {

class TwoClocks : public Method {
public:
  using Method::Method;

  [[nodiscard]] std::vector<SearchedChannel> searches() const override;
  [[nodiscard]] Evaluation evaluation(std::size_t step, const RunRecords& records) override;
  [[nodiscard]] std::optional<std::string> clock_source() const override;

protected:
  // Looks at nothing but its arguments.
  using StepEvaluation = std::vector<StepResult> (*)(StepTask task, SourceInterval acs,
                                                     SourceInterval dau);

private:
  [[nodiscard]] virtual StepEvaluation step_evaluation() const = 0;
  // Of a step that was not found in `sync`.
  [[nodiscard]] virtual Evaluation without(std::size_t step, const RunRecords& records,
                                           const ChannelName& sync) const = 0;
};

} // namespace dyncal::inline evaluation
