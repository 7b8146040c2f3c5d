#include "services/replay/measured_later.hpp"

#include <vector>

#include <fmt/core.h>

namespace dyncal::services {
namespace {

StepResult without_value(const StepResult& result, std::string problem) {
  StepResult refused;
  refused.channel = result.channel;
  refused.step = result.step;
  refused.repetition = result.repetition;
  refused.attempt = result.attempt;
  refused.frequency_text_hz = result.frequency_text_hz;
  refused.frequency_hz = result.frequency_hz;
  refused.level_m_s2 = result.level_m_s2;
  refused.problem = std::move(problem);
  return refused;
}

} // namespace

void MeasuredLater::add(const StepAnnouncement& announcement, std::int64_t recorded_ns) {
  if (announcement.state != StepAnnouncement::State::excited) {
    over_ns_.emplace(std::pair(announcement.step, announcement.attempt), recorded_ns);
  }
}

void MeasuredLater::add(const std::string& source, const SourceBlock& block, std::int64_t sent_ns) {
  if (block.samples > 0) {
    const std::int64_t last_ns = block.stamps_ns.empty()
                                     ? block.clock.stamp_ns(block.first_sample + block.samples - 1)
                                     : block.stamps_ns.back();
    sent_ns_[source].emplace(last_ns, sent_ns);
  }
}

void MeasuredLater::refuse(RunOutcome& outcome) const {
  for (StepResult& result : outcome.results) {
    std::string problem = result.valid ? problem_of(result) : "";
    if (!problem.empty()) {
      std::erase_if(outcome.transfer_functions, [&](const TransferFunction& function) {
        return function.channel == result.channel;
      });
      result = without_value(result, std::move(problem));
    }
  }
}

// Empty where the value is not of a later step.
std::string MeasuredLater::problem_of(const StepResult& result) const {
  const auto over = over_ns_.find(std::pair(result.step, result.attempt));
  if (over == over_ns_.end()) {
    return "";
  }
  for (const SourceSamples& samples : result.samples) {
    const auto source = sent_ns_.find(samples.source);
    if (source == sent_ns_.end()) {
      continue;
    }
    const std::int64_t half_ns = (samples.last_stamp_ns - samples.first_stamp_ns) / 2;
    const std::int64_t middle_ns = samples.first_stamp_ns + half_ns;
    const auto block = source->second.lower_bound(middle_ns);
    if (block == source->second.end()) {
      continue;
    }
    const std::int64_t late_ns = block->second - (block->first - middle_ns) - over->second;
    if (late_ns > half_ns) {
      return fmt::format("the sine of {} Hz that '{}' shows was measured {:.1f} s after this step "
                         "was over: the recording lacks the step in '{}'",
                         result.frequency_text_hz, samples.source,
                         static_cast<double>(late_ns) * 1e-9, samples.source);
    }
  }
  return "";
}

} // namespace dyncal::services
