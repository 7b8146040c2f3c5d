// Result files of runs for tests of the store: the example run of the reports, with other names,
// times and values.
#pragma once

#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "services/views/report/result_json.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::tests {

struct ExampleResult {
  std::string run = "r1";
  std::int64_t days = 0; // after the first
  double magnitude = 1.0;
  bool ended = true;
  std::string serial = "mpu-7"; // of the sensor's source
  std::string recipe_sha256 = "abc";
};

inline evaluation::RunOutcome outcome_of(const ExampleResult& example) {
  constexpr std::int64_t day_ns = 86'400'000'000'000;
  evaluation::RunOutcome outcome = example_outcome();
  outcome.run = example.run;
  outcome.recipe_sha256 = example.recipe_sha256;
  outcome.began_utc_ns += example.days * day_ns;
  outcome.ended_utc_ns = example.ended ? outcome.ended_utc_ns + example.days * day_ns : 0;
  outcome.sources.push_back({"dau", contract::SourceKind::dau, "dyncal 1.2.3", {}});
  outcome.sources.back().description.device = "SmartUp";
  outcome.sources.back().description.serial = example.serial;
  outcome.results.front().data_sha256 = std::string(64, 'd');
  outcome.results.front().magnitude *= example.magnitude;
  for (evaluation::FrequencyPoint& point : outcome.transfer_functions.front().points) {
    point.mean.magnitude = example.magnitude;
  }
  return outcome;
}

inline std::string text_of(const evaluation::RunOutcome& outcome) {
  return views::result_json(outcome).dump(1) + "\n";
}

} // namespace dyncal::tests
