#include "services/evaluation/method/step_task.hpp"

#include <fmt/format.h>

namespace dyncal::services {

StepTask make_step_task(std::shared_ptr<const Recipe> recipe, std::size_t index,
                        const ExcitationProgress& excitation,
                        const std::vector<SourceInterval>& sources) {
  StepTask task{std::move(recipe), index};
  for (const auto& [record, interval] : sources) {
    if (record->lost_in(interval).all() > 0) {
      task.flags.push_back(flag_of_source(ResultFlag::samples_lost, record->source()));
    }
    if (!task.recipe->whole_record && static_cast<double>(interval.end_ns - interval.begin_ns) <
                                          0.95e9 * task.step().duration_s) {
      task.flags.push_back(flag_of_source(ResultFlag::shorter_than_planned, record->source()));
    }
  }
  if (excitation.is_broken_off(index)) {
    task.flags.push_back(make_flag(ResultFlag::excitation_broken_off));
  }
  return task;
}

std::string no_sine(const RecipeStep& step, const ChannelName& sync) {
  return fmt::format("no steady sine of {} Hz was found in {}; is the sync signal connected?",
                     step.frequency_text_hz, sync.text());
}

} // namespace dyncal::services
