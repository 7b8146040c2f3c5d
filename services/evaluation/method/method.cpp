#include "services/evaluation/method/method.hpp"

#include "services/evaluation/method/flag_of_most.hpp"
#include "services/evaluation/method/method_kinds.hpp"
#include "services/evaluation/method/series_time_stamping.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_task.hpp"

namespace dyncal::inline evaluation {

Expected<void> Method::check_time_scales(const RunRecords& /*records*/) const {
  return {};
}

void Method::add(const std::string& /*source*/, TriggeredRecord /*record*/) {}

void Method::add(ReferenceStep /*step*/) {}

bool Method::settle(std::span<StepResult> results) const {
  return add_flag_of_most(ResultFlag::changed_within_step, results);
}

bool Method::is_complete(std::size_t /*step*/, const RunRecords& /*records*/) const {
  return true;
}

Evaluation Method::not_found(std::size_t step, const RunRecords& records, const ChannelName& sync,
                             const std::vector<ChannelName>& dut) const {
  return [results = results_without_value(records.planned(step), dut,
                                          no_sine(*recipe_, records, step, sync))](
             const std::stop_token&) { return results; };
}

std::unique_ptr<Method> make_method(std::shared_ptr<const Recipe> recipe) {
  switch (recipe->method()) {
  case EvaluationMethod::analogue:
    return make_analogue(std::move(recipe));
  case EvaluationMethod::absolute_time:
    return make_absolute_time(std::move(recipe));
  case EvaluationMethod::series_timestamping:
    return std::make_unique<SeriesTimeStamping>(std::move(recipe));
  case EvaluationMethod::sample_timestamping:
    break;
  }
  if (recipe->is_multisine()) {
    return make_multisine_time_stamping(std::move(recipe));
  }
  if (!recipe->reference_table.empty()) {
    return make_table_sample_stamping(std::move(recipe));
  }
  if (has_own_clocks(recipe->dut(), recipe->roles.sync_sensor)) {
    return make_own_clock_sample_stamping(std::move(recipe));
  }
  return make_sample_time_stamping(std::move(recipe));
}

} // namespace dyncal::inline evaluation
