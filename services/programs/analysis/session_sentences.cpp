#include "services/programs/analysis/session_sentences.hpp"

#include <fmt/core.h>

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
