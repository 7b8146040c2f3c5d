#include "services/evaluation/method/step_task.hpp"

#include <algorithm>
#include <cstdint>

#include <fmt/core.h>

namespace dyncal::services {
namespace {

constexpr double max_distrusted_part = 0.2; // of the stamps: with more they are the likely reason

double distrusted_part(const SourceRecord& source) {
  const auto flags = source.flags();
  const auto distrusted = static_cast<double>(
      std::count_if(flags.begin(), flags.end(), [](std::uint8_t flag) { return flag != 0; }));
  return flags.empty() ? 0.0 : distrusted / static_cast<double>(flags.size());
}

std::string likely_cause(const RunRecords& records, const std::string& name) {
  const SourceRecord& source = records.of(name);
  if (source.restarts() > 0) {
    return fmt::format(": source '{}' restarted during the run", name);
  }
  if (!source.newest_stamp_ns()) {
    return fmt::format(": source '{}' sent no samples", name);
  }
  if (const double part = distrusted_part(source); part > max_distrusted_part) {
    return fmt::format(": {:.0f} % of its time stamps are not trusted; has its clock lost its fix, "
                       "or does it lose samples that its numbers do not show?",
                       100.0 * part);
  }
  if (records.excitation().is_cut_short()) {
    return fmt::format(": the run ended before source '{}' had sent it", name);
  }
  if (const std::uint64_t lost = source.lost() + source.overflowed(); lost > 0) {
    return fmt::format(": source '{}' lost {} samples during the run", name, lost);
  }
  return "; is the sync signal connected?";
}

} // namespace

StepTask make_step_task(std::shared_ptr<const Recipe> recipe, std::size_t step,
                        const ExcitationProgress& excitation,
                        const std::vector<SourceInterval>& sources) {
  StepTask task{std::move(recipe), excitation.order().index(step)};
  for (const SourceInterval& source : sources) {
    const auto& record = source.record;
    const TimeInterval& interval = source.interval;
    if (record->lost_in(interval).all() > 0) {
      task.flags.push_back(flag_of_source(ResultFlag::samples_lost, record->source()));
    }
    if (!task.recipe->whole_record && static_cast<double>(interval.end_ns - interval.begin_ns) <
                                          0.95e9 * task.step().duration_s) {
      task.flags.push_back(flag_of_source(ResultFlag::shorter_than_planned, record->source()));
    }
  }
  if (excitation.is_broken_off(step)) {
    task.flags.push_back(make_flag(ResultFlag::excitation_broken_off));
  }
  return task;
}

std::string no_sine(const RunRecords& records, const RecipeStep& step, const ChannelName& sync) {
  return fmt::format("no steady sine of {} Hz was found in {}{}", step.frequency_text_hz,
                     sync.text(), likely_cause(records, sync.source));
}

} // namespace dyncal::services
