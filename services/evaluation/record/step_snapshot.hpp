// What the evaluation of a step looks at in the records of a run, to know later whether all of it
// is still the same: intervals, samples and losses of every source in them, and whether the
// excitation was broken off.
//
// Belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/evaluation/record/run_records.hpp"

namespace dyncal::inline evaluation {

class StepSnapshot {
public:
  StepSnapshot(const RunRecords& records, std::size_t step);

  [[nodiscard]] std::size_t step() const { return step_; }

  // The step would be evaluated from the same. Costs time for the samples that have come since it
  // was asked last.
  [[nodiscard]] bool still_holds(const RunRecords& records);

private:
  struct Source {
    std::string name;
    std::optional<TimeInterval> interval;
    std::uint32_t restarts = 0;
    std::uint64_t overflowed = 0;
    SampleLoss lost{};
    std::uint64_t received = 0; // samples that were looked at
  };

  [[nodiscard]] static Source source_of(const RunRecords& records, const std::string& name,
                                        std::size_t step);

  std::size_t step_;
  bool broken_off_;
  std::vector<Source> sources_;
};

} // namespace dyncal::inline evaluation
