// Where every step of a run is in the records, from somebody who has looked at all of them before
// the evaluation begins (step_alignment.hpp). Plain data; any thread.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/evaluation/record/time_interval.hpp"

namespace dyncal::inline evaluation {

struct ScheduledStep {
  std::int64_t search_from_ns = 0; // end of the excitation before it in this record
  TimeInterval excited{};
  std::optional<TimeInterval> evaluated{}; // of a step within which the record begins
  friend bool operator==(const ScheduledStep&, const ScheduledStep&) = default;
};

struct RunSchedule {
  // By step in the order of their excitation; nothing: the record does not show the step.
  using OfRecord = std::vector<std::optional<ScheduledStep>>;

  std::vector<OfRecord> records;     // in the order of the method's searches
  std::vector<std::string> problems; // by step: why it has no value; empty where it has one
  std::vector<bool> uncertain;       // by step: what is there, may as well be another step

  [[nodiscard]] bool shows_any_step() const {
    return std::any_of(records.begin(), records.end(), [](const OfRecord& record) {
      return std::any_of(record.begin(), record.end(),
                         [](const auto& step) { return step.has_value(); });
    });
  }
};

} // namespace dyncal::inline evaluation
