// How much room a run needs on the disk, before it begins.
//
//   recording   of every source: rate x (8 bytes a channel + 13 of stamp, uncertainty and flags) x
//               planned time, 20 % more for repeated steps, headers and the other topics; of a
//               played file its size, of triggered records 1 MB a shot
//   results     16 kB a step and channel, twice (the old file stands until the new one is whole),
//               and 16 MB for figures and log
//
// A source whose rate nobody knows is taken to have 10 000 samples/s. An estimate, on the safe
// side. Plain functions, any thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "services/bench/file/bench_file.hpp"
#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::inline records {

struct SpaceEstimate {
  std::uint64_t recording_bytes = 0;
  std::uint64_t results_bytes = 0;

  [[nodiscard]] std::uint64_t bytes() const { return recording_bytes + results_bytes; }
};

// Of all planned steps; those that were measured already count as well. `rates_hz` by source, as
// measured, for sources that do not state theirs.
[[nodiscard]] SpaceEstimate estimate_space(const RunOutcome& planned, const BenchFile& bench,
                                           const std::map<std::string, double>& rates_hz,
                                           bool recorded);

// "1.3 GB"
[[nodiscard]] std::string size_text(std::uint64_t bytes);

} // namespace dyncal::inline records
