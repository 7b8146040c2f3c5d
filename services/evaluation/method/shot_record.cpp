#include "services/evaluation/method/shot_record.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::services {
namespace {

bool usable(const wire::TriggeredRecord& record) {
  const std::uint64_t wanted = std::uint64_t{record.sample_count()} * record.channel_count();
  return wanted > 0 && record.values().size() == wanted && record.interval_s() > 0.0 &&
         std::isfinite(record.first_sample_s()) &&
         std::all_of(record.values().begin(), record.values().end(),
                     [](double value) { return std::isfinite(value); });
}

} // namespace

void ShotRecord::add(Records& records, const wire::TriggeredRecord& record) {
  if (record.sample_count() == 0 && record.values().empty()) {
    return; // an answer, or the end of the stream
  }
  if (!usable(record)) {
    ++unusable_;
    return;
  }
  if (records.size() >= capacity) {
    ++overflowed_;
    return;
  }
  records.insert_or_assign(Key{record.session(), record.shot()}, record);
}

std::vector<ShotRecord::Shot> ShotRecord::of_step(std::uint32_t step) const {
  std::vector<Shot> shots;
  for (const auto& [key, trace] : traces_) {
    const auto series = series_.find(key);
    if (trace.step() == step && series != series_.end() && series->second.step() == step) {
      shots.push_back({&trace, &series->second});
    }
  }
  return shots;
}

void ShotRecord::forget_step(std::uint32_t step) {
  const auto of_that_step = [&](const auto& entry) { return entry.second.step() == step; };
  std::erase_if(traces_, of_that_step);
  std::erase_if(series_, of_that_step);
}

std::span<const double> channel_of(const wire::TriggeredRecord& record, std::size_t channel) {
  return std::span<const double>(record.values())
      .subspan(channel * record.sample_count(), record.sample_count());
}

} // namespace dyncal::services
