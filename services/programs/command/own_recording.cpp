#include "services/programs/command/own_recording.hpp"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <thread>

#include <fmt/core.h>

#include "services/evaluation/outcome_agreement.hpp"
#include "services/records/exchange/opened_recording.hpp"
#include "services/records/replay/recorded_run.hpp"

namespace dyncal::inline programs {
namespace {

constexpr std::int64_t limit_part = 10; // of the run's time

// Until the timer's own end requests a stop when the time is over.
std::jthread stop_after(std::chrono::nanoseconds limit, std::stop_source& stop) {
  return std::jthread(
      [&stop, until = std::chrono::steady_clock::now() + limit](const std::stop_token& ended) {
        std::mutex mutex;
        std::unique_lock lock(mutex);
        std::condition_variable_any().wait_until(lock, ended, until, [] { return false; });
        if (!ended.stop_requested()) {
          stop.request_stop();
        }
      });
}

Expected<RecordedRunOutcome> evaluate(const RunOutcome& outcome,
                                      const std::filesystem::path& folder,
                                      const std::stop_token& stop) {
  DYNCAL_TRY(auto opened, open_recording(folder, nullptr, stop));
  return evaluate_recording(opened.reader,
                            {.run = outcome.run, .recipe = {}, .whole_or_none = true}, stop);
}

OwnRecordingCheck differing(const OutcomeAgreement& agreement, bool may_lack,
                            const std::filesystem::path& folder) {
  const std::size_t lacking = may_lack ? 0 : agreement.missing;
  std::string what = agreement.difference;
  if (what.empty()) {
    what = fmt::format("{} of {} values are not in it", lacking, agreement.values);
  } else if (agreement.differing + lacking > 1) {
    what += fmt::format(", and {} more of {} values", agreement.differing + lacking - 1,
                        agreement.values);
  }
  return {fmt::format("THE RUN'S OWN RECORDING GIVES SOMETHING ELSE than came live ({}); use "
                      "neither before it is known why: 'dyncal analyse {}'",
                      what, folder.string()),
          true};
}

} // namespace

std::string not_held(const std::string& reason) {
  return fmt::format("the results were not held against the recording of the run: {}", reason);
}

OwnRecordingCheck check_own_recording(const RunOutcome& outcome,
                                      const std::filesystem::path& run_folder, bool may_lack,
                                      const std::stop_token& stop) {
  const auto by_hand = fmt::format("; 'dyncal analyse {}' does it", run_folder.string());
  const auto began = std::chrono::steady_clock::now();
  const auto limit = std::max<std::chrono::nanoseconds>(
      least_limit,
      std::chrono::nanoseconds((outcome.ended_utc_ns - outcome.began_utc_ns) / limit_part));
  std::stop_source end;
  const std::stop_callback by_user(stop, [&end] { end.request_stop(); });
  const auto again = [&] {
    const std::jthread timer = stop_after(limit, end);
    return evaluate(outcome, run_folder, end.get_token());
  }();
  if (end.stop_requested()) {
    const double limit_s = std::chrono::duration<double>(limit).count();
    return {not_held((stop.stop_requested()
                          ? std::string("interrupted")
                          : fmt::format("it would take longer than {:.0f} s", limit_s)) +
                     by_hand)};
  }
  if (!again) {
    return {not_held(again.error().message)};
  }
  may_lack = may_lack || again->source_restarted;
  const OutcomeAgreement agreement = hold_against(outcome, again->outcome);
  if (!agreement.difference.empty() || (agreement.missing > 0 && !may_lack)) {
    return differing(agreement, may_lack, run_folder);
  }
  if (agreement.missing == agreement.values) {
    return {not_held(agreement.values == 0 ? "no value is valid" : "it has none of the samples")};
  }
  const double took_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  const std::string rest =
      agreement.missing == 0
          ? ""
          : fmt::format("; of the other {} it has fewer samples, or none", agreement.missing);
  return {fmt::format("the recording of the run, evaluated once more, gives the same {} values "
                      "({:.1f} s){}",
                      agreement.values - agreement.missing, took_s, rest)};
}

} // namespace dyncal::inline programs
