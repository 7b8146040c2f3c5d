// What a run at the analysis service says of its work, for people. Plain functions.
#pragma once

#include <chrono>
#include <string>

#include "services/evaluation/run_evaluator.hpp"
#include "services/programs/analysis/source_streams.hpp"

namespace dyncal::inline programs {

// Of a bench that another run has, or is given to.
[[nodiscard]] std::string waiting_for_bench_sentence(const std::string& run);
[[nodiscard]] std::string bench_in_use_sentence(const std::string& bench, const std::string& run,
                                                const std::string& conductor);
[[nodiscard]] std::string bench_given_sentence(std::chrono::seconds silence,
                                               const std::string& next_run);

[[nodiscard]] std::string taking_over_sentence(const SourceStreams& streams);

// That two programs send as one source, and what takes longer than a result should, so that anyone
// who waits for results goes on waiting; empty where nothing is to be said. `waited`: since the
// last progress.
[[nodiscard]] std::string attending_sentence(const RunEvaluator& evaluator,
                                             const SourceStreams& streams,
                                             std::chrono::nanoseconds waited);

} // namespace dyncal::inline programs
