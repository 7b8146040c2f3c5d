#include "services/evaluation/record/shot_record.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::inline evaluation {
namespace {

bool is_usable(const TriggeredRecord& record) {
  const std::size_t expected = record.samples * record.channels;
  return expected > 0 && record.values.size() == expected && record.interval_s > 0.0 &&
         std::isfinite(record.first_sample_s) &&
         std::ranges::all_of(record.values, [](double value) { return std::isfinite(value); });
}

StepAttempt attempt_of(const TriggeredRecord& record) {
  return {record.step, record.attempt};
}

} // namespace

void ShotRecord::add_trace(TriggeredRecord record) {
  Loss& loss = lost_[attempt_of(record)].traces;
  add(traces_, std::move(record), loss);
}

void ShotRecord::add_series(TriggeredRecord record) {
  Loss& loss = lost_[attempt_of(record)].series;
  add(series_, std::move(record), loss);
}

void ShotRecord::add(Records& records, TriggeredRecord record, Loss& loss) {
  if (record.samples == 0 && record.values.empty()) {
    return; // an answer, or the end of the stream
  }
  const bool usable = is_usable(record);
  if (!usable || records.size() >= capacity) {
    ++loss.records;
    (usable ? loss.overflowed_samples : loss.unusable_samples) += record.samples;
    return;
  }
  const Key key{record.session, record.shot};
  records.insert_or_assign(key, std::move(record));
}

std::vector<ShotRecord::Shot> ShotRecord::of_step(StepAttempt step) const {
  std::vector<Shot> shots;
  for (const auto& [key, trace] : traces_) {
    const auto series = series_.find(key);
    if (attempt_of(trace) == step && series != series_.end() &&
        attempt_of(series->second) == step) {
      shots.push_back({&trace, &series->second});
    }
  }
  return shots;
}

ShotRecord::Losses ShotRecord::lost_in(StepAttempt step) const {
  const auto found = lost_.find(step);
  return found == lost_.end() ? Losses{} : found->second;
}

void ShotRecord::forget_step(StepAttempt step) {
  const auto of_that_step = [&](const auto& entry) { return attempt_of(entry.second) == step; };
  std::erase_if(traces_, of_that_step);
  std::erase_if(series_, of_that_step);
  lost_.erase(step);
}

} // namespace dyncal::inline evaluation
