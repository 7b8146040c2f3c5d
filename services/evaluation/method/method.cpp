#include "services/evaluation/method/method.hpp"

#include "services/evaluation/method/absolute_time.hpp"
#include "services/evaluation/method/analogue.hpp"
#include "services/evaluation/method/flag_of_most.hpp"
#include "services/evaluation/method/own_clock_sample_stamping.hpp"
#include "services/evaluation/method/sample_time_stamping.hpp"
#include "services/evaluation/method/series_time_stamping.hpp"

namespace dyncal::inline evaluation {

Expected<void> Method::check_time_scales(const RunRecords& /*records*/) const {
  return {};
}

void Method::add(const std::string& /*source*/, TriggeredRecord /*record*/) {}

bool Method::settle(std::span<StepResult> results) const {
  return add_flag_of_most(ResultFlag::changed_within_step, results);
}

bool Method::is_complete(std::size_t /*step*/, const RunRecords& /*records*/) const {
  return true;
}

std::unique_ptr<Method> make_method(std::shared_ptr<const Recipe> recipe) {
  switch (recipe->method()) {
  case EvaluationMethod::analogue:
    return std::make_unique<Analogue>(std::move(recipe));
  case EvaluationMethod::absolute_time:
    return std::make_unique<AbsoluteTime>(std::move(recipe));
  case EvaluationMethod::series_timestamping:
    return std::make_unique<SeriesTimeStamping>(std::move(recipe));
  case EvaluationMethod::sample_timestamping:
    break;
  }
  if (std::get<SampleStampingRoles>(recipe->roles).own_clocks()) {
    return std::make_unique<OwnClockSampleStamping>(std::move(recipe));
  }
  return std::make_unique<SampleTimeStamping>(std::move(recipe));
}

} // namespace dyncal::inline evaluation
