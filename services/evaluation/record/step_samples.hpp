// The samples of one source that belong to a step: selected from its record, cleaned, each sample
// once.
//
// Left out and counted: samples whose stamp is not trusted (flags; those too whose stamp lies
// outside, but that came between others of the step), does not increase, or that were not measured
// (NaN) in a column asked for. As a rule nothing must be left out: then these are
// views of the record, and nothing is copied.
//
// Plain functions, any thread; REQUIRES: the record lives on and does not change as long as they
// are looked at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "services/evaluation/record/source_record.hpp"
#include "services/evaluation/record/time_interval.hpp"

namespace dyncal::inline evaluation {

struct StepSamples {
  struct Copies {
    std::vector<std::int64_t> stamps_ns;
    std::vector<std::vector<double>> columns;
  };

  std::span<const std::int64_t> stamps_ns;
  std::vector<std::span<const double>> columns;
  std::uint64_t not_trusted = 0;
  std::uint64_t not_measured = 0;
  std::uint64_t cut_out = 0;
  std::shared_ptr<const Copies> copies; // where they lie when samples between them were left out
};

[[nodiscard]] StepSamples select_samples(const SourceRecord& record, const TimeInterval& interval,
                                         const std::vector<std::size_t>& channels);

} // namespace dyncal::inline evaluation
