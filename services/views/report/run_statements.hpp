// What is known of a run beside its samples, and no evaluation can find again: who conducted it,
// the check that it rests on, a comment, the conditions that were logged. Who conducts the run
// states it; it stands in the result file (result.schema.json), and is not part of what evaluating
// the recording once more must give. Plain data; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/base/acting_person.hpp"
#include "services/views/report/daily_check.hpp"

namespace dyncal::inline views {

// A quantity of the surroundings over a run, as a logger had it.
struct LoggedCondition {
  std::string quantity; // "temperature", "humidity", "pressure"
  std::string unit;     // "degC", "%", "hPa"
  std::string source;   // "file logger.csv, Testo 174H"
  std::uint64_t count = 0;
  double minimum = 0.0; // of no readings: NaN, as the next two
  double mean = 0.0;
  double maximum = 0.0;
  double expanded = 0.0; // of one reading, k = 2
  std::string problem;   // why readings are missing; empty: none are

  // Of the mean as the condition over the run: that of a reading, and how far it went (k = 2).
  [[nodiscard]] double expanded_over_run() const;
};

struct RunStatements {
  std::optional<DailyCheck> check{};          // of the bench; nothing: the run does not say
  std::optional<ActingPerson> conducted_by{}; // nothing: not known
  std::string comment{};
  std::string sensor{}; // its serial number in the library; empty: as the bench file says
  std::vector<LoggedCondition> conditions{};
};

} // namespace dyncal::inline views
