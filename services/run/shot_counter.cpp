#include "services/run/shot_counter.hpp"

#include <algorithm>

#include "services/contract/topics.hpp"

namespace dyncal::inline run {

Expected<ShotCounter> ShotCounter::create(bus::Participant& participant, const std::string& bench,
                                          const std::shared_ptr<bus::WakeUp>& wake_up) {
  DYNCAL_TRY(auto traces, participant.reader<wire::TriggeredRecord>(
                              bus::topics::dso_record, bus::Profile::live_samples, bench, wake_up));
  DYNCAL_TRY(auto series, participant.reader<wire::TriggeredRecord>(
                              bus::topics::tss_record, bus::Profile::live_samples, bench, wake_up));
  return ShotCounter(std::move(traces), std::move(series));
}

void ShotCounter::begin(const std::string& run, std::uint32_t step, std::uint32_t attempt) {
  run_ = run;
  step_ = step;
  attempt_ = attempt;
  trace_numbers_.clear();
  series_numbers_.clear();
}

void ShotCounter::take(bus::Reader<wire::TriggeredRecord>& reader, Numbers& numbers) const {
  reader.take([&](const wire::TriggeredRecord& record) {
    if (record.sample_count() > 0 && record.step() == step_ &&
        std::max(record.attempt(), 1U) == attempt_ && record.run() == run_) {
      numbers.insert({record.session(), record.shot()});
    }
  });
}

int ShotCounter::shots() {
  take(traces_, trace_numbers_);
  take(series_, series_numbers_);
  return static_cast<int>(std::ranges::count_if(
      trace_numbers_, [&](const auto& number) { return series_numbers_.contains(number); }));
}

} // namespace dyncal::inline run
