// The samples of one source that belong to a step: cut out of its record, cleaned, each sample
// once.
//
// Left out and counted: samples whose stamp is not trusted (flags), does not increase, or that were
// not measured (NaN) in a column asked for. As a rule nothing must be left out: then these are
// views of the record, and nothing is copied. Plain functions, any thread; REQUIRES: the record
// lives on and does not change as long as they are looked at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "services/evaluation/source_record.hpp"

namespace dyncal::services {

struct StretchOfTime { // in a source's own clock, both ends included
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
};

struct StepSamples {
  struct Copies {
    std::vector<std::int64_t> stamps_ns;
    std::vector<std::vector<double>> columns;
  };

  std::span<const std::int64_t> stamps_ns;
  std::vector<std::span<const double>> columns;
  std::uint64_t not_trusted = 0;
  std::shared_ptr<const Copies> copies; // where they lie when samples between them were left out
};

[[nodiscard]] StepSamples cut(const SourceRecord& record, const StretchOfTime& stretch,
                              const std::vector<std::size_t>& channels);

} // namespace dyncal::services
