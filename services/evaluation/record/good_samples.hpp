// Hands the samples of a channel whose stamps are trusted to a search for excitations. Plain
// function; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "analysis/step/excitation_window.hpp"
#include "services/evaluation/record/source_record.hpp"

namespace dyncal::inline evaluation {

struct SampleRange {
  std::size_t first = 0; // of those that the record holds
  std::int64_t begin_ns = std::numeric_limits<std::int64_t>::min();
  std::int64_t end_ns = std::numeric_limits<std::int64_t>::max(); // not included
};

void push_good_samples(const SourceRecord& record, std::size_t channel, const SampleRange& range,
                       analysis::ExcitationWindowFinder& finder);

} // namespace dyncal::inline evaluation
