#include "services/evaluation/record/step_snapshot.hpp"

#include <algorithm>

namespace dyncal::inline evaluation {

StepSnapshot::StepSnapshot(const RunRecords& records, std::size_t step)
    : step_(step), broken_off_(records.excitation().is_broken_off(step)) {
  for (const std::string& name : records.sources()) {
    sources_.push_back(source_of(records, name, step));
  }
}

StepSnapshot::Source StepSnapshot::source_of(const RunRecords& records, const std::string& name,
                                             std::size_t step) {
  const SourceRecord& record = records.of(name);
  Source source;
  source.name = name;
  source.interval = records.interval_in(name, step);
  if (source.interval) {
    source.restarts = record.restarts();
    source.overflowed = record.overflowed();
    source.lost = record.lost_in(*source.interval);
    source.received = record.forgotten() + record.stamps_ns().size();
  }
  return source;
}

bool StepSnapshot::still_holds(const RunRecords& records) {
  if (records.excitation().is_broken_off(step_) != broken_off_) {
    return false;
  }
  return std::all_of(sources_.begin(), sources_.end(), [&](Source& before) {
    const Source now = source_of(records, before.name, step_);
    if (now.interval != before.interval || now.restarts != before.restarts ||
        now.overflowed != before.overflowed || now.lost != before.lost) {
      return false;
    }
    if (!now.interval) {
      return true;
    }
    // What has come since lies behind the interval, unless a clock stepped back.
    const auto since = records.of(before.name).stamps_ns().last(now.received - before.received);
    before.received = now.received;
    return std::all_of(since.begin(), since.end(),
                       [&](std::int64_t stamp) { return stamp > now.interval->end_ns; });
  });
}

} // namespace dyncal::inline evaluation
