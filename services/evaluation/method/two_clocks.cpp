#include "services/evaluation/method/two_clocks.hpp"

#include <utility>

namespace dyncal::inline evaluation {

std::vector<SearchedChannel> TwoClocks::searches() const {
  return {{roles_.sync_acs, {roles_.sync_acs.source}},
          {roles_.sync_sensor, {roles_.sync_sensor.source}}};
}

std::optional<std::string> TwoClocks::clock_source() const {
  return roles_.sync_sensor.source;
}

Evaluation TwoClocks::evaluation(std::size_t step, const RunRecords& records) {
  const auto of_acs = records.interval(0, step);
  const auto of_dau = records.interval(1, step);
  if (!of_acs || !of_dau) {
    return without(step, records, of_acs ? roles_.sync_sensor : roles_.sync_acs);
  }
  SourceInterval acs = records.samples(roles_.sync_acs.source, *of_acs);
  SourceInterval dau = records.samples(roles_.sync_sensor.source, *of_dau);
  StepTask task = make_step_task(recipe_, step, records, {acs, dau});
  return [evaluate = step_evaluation(), task = std::move(task), acs = std::move(acs),
          dau = std::move(dau)](const std::stop_token& stop) {
    return evaluate(task.until(stop), acs, dau);
  };
}

} // namespace dyncal::inline evaluation
