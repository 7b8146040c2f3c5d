#include "services/programs/analysis/session_sentences.hpp"

#include <fmt/core.h>

#include "services/contract/run_identity.hpp"

namespace dyncal::inline programs {

using namespace std::chrono_literals;

namespace {

// What takes longer than a result should.
std::string work_sentence(const RunEvaluator& evaluator, const SourceStreams& streams,
                          std::chrono::nanoseconds waited) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(waited);
  if (evaluator.is_evaluating() && seconds > 1s) {
    return fmt::format("evaluating a step, for {} s so far", seconds.count());
  }
  if (streams.is_catching_up() && (streams.recovered() > 0 || seconds > 0s)) {
    return fmt::format("catching up with what the sources have sent: {} messages so far, none for "
                       "{} s",
                       streams.recovered(), seconds.count());
  }
  return "";
}

} // namespace

std::string waiting_for_bench_sentence(const std::string& run) {
  return fmt::format("waiting for run '{}' of this bench to end", RunIdentity::parse(run).name);
}

std::string bench_in_use_sentence(const std::string& bench, const std::string& run,
                                  const std::string& conductor) {
  return fmt::format("bench '{}' is in use by {}; wait for its end, or end it there", bench,
                     called_of(run, conductor));
}

std::string bench_given_sentence(std::chrono::seconds silence, const std::string& next_run) {
  return fmt::format("nothing was heard of this run for {} s; its bench was given to run '{}'",
                     silence.count(), RunIdentity::parse(next_run).name);
}

std::string taking_over_sentence(const SourceStreams& streams) {
  return fmt::format("taking the run over; its sources have repeated {} messages so far",
                     streams.recovered());
}

std::string attending_sentence(const RunEvaluator& evaluator, const SourceStreams& streams,
                               std::chrono::nanoseconds waited) {
  const std::string second_writer = streams.second_writer();
  const std::string work = work_sentence(evaluator, streams, waited);
  return second_writer + (second_writer.empty() || work.empty() ? "" : "; ") + work;
}

} // namespace dyncal::inline programs
