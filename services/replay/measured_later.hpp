// Refuses values of a recorded run that are of a later step than they are given for.
//
// A source whose recording lacks the first steps shows later ones of their frequencies, which
// nothing in its samples tells from them. When they were measured does: the middle of the samples
// that a value rests on, by the recorder's clock, against the instant at which the conductor
// announced that the step was over. What is sent late, is so by less than half of their length;
// another step is later by more. Where a value is refused, the means of its channel are too.
//
// Units: ns. Belongs to one thread; does not fail.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "services/evaluation/record/excitation_progress.hpp"
#include "services/evaluation/record/source_record.hpp"
#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::services {

class MeasuredLater {
public:
  void add(const StepAnnouncement& announcement, std::int64_t recorded_ns);
  // `sent_ns`: when the block was sent, by the recorder's clock.
  void add(const std::string& source, const SourceBlock& block, std::int64_t sent_ns);
  void refuse(RunOutcome& outcome) const;

private:
  // Of the blocks of a source, when they were sent, by their last stamps.
  using Sent = std::map<std::int64_t, std::int64_t>;

  [[nodiscard]] std::string problem_of(const StepResult& result) const;

  std::map<std::string, Sent> sent_ns_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::int64_t> over_ns_; // by step and attempt
};

} // namespace dyncal::services
