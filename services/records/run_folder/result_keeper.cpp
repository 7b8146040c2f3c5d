#include "services/records/run_folder/result_keeper.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include "services/evaluation/outcome_agreement.hpp"
#include "services/views/report/result_json.hpp"
#include "services/views/report/show_outcome.hpp"

namespace dyncal::inline records {
namespace {

constexpr const char* not_ended = "the run has not ended, or its program ended before it";

void complete(RunOutcome& so_far) {
  sort_outcome(so_far);
  so_far.problem = not_ended;
  if (so_far.recipe) {
    take_means_of_results(so_far);
  }
}

} // namespace

ResultKeeper::ResultKeeper(std::filesystem::path path)
    : path_(std::move(path)), thread_([this](const std::stop_token& stop) { write_newest(stop); }) {
}

ResultKeeper::~ResultKeeper() {
  stop();
}

void ResultKeeper::set_statements(RunStatements stated) {
  const std::lock_guard lock(mutex_); // not that of the disk
  stated_ = std::move(stated);
}

RunStatements ResultKeeper::statements() const {
  const std::lock_guard lock(mutex_);
  return stated_;
}

// REQUIRES: writing_ is locked, mutex_ is not.
Expected<void> ResultKeeper::write(const RunOutcome& state) {
  return write_json(path_, result_json(state, statements()));
}

Expected<void> ResultKeeper::begin(RunOutcome planned) {
  complete(planned);
  const std::lock_guard writing(writing_);
  if (results_kept() > planned.results.size()) {
    return {}; // of a resumed run: more has come meanwhile
  }
  return write(planned);
}

void ResultKeeper::keep(RunOutcome so_far) {
  {
    const std::lock_guard lock(mutex_);
    newest_ = std::move(so_far);
  }
  changed_.notify_one();
}

std::size_t ResultKeeper::results_kept() const {
  const std::lock_guard lock(mutex_);
  return results_kept_;
}

std::optional<Error> ResultKeeper::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

void ResultKeeper::write_newest(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return newest_.has_value(); })) {
    RunOutcome state = *std::exchange(newest_, std::nullopt);
    lock.unlock();
    complete(state);
    const std::lock_guard writing(writing_);
    const auto written = write(state);
    lock.lock();
    problem_ = written ? std::nullopt : std::optional(written.error());
    results_kept_ = written ? state.results.size() : results_kept_;
    if (stop.stop_requested()) {
      return; // the final state follows
    }
  }
}

void ResultKeeper::stop() {
  thread_.request_stop();
  if (thread_.joinable()) {
    thread_.join();
  }
}

Expected<void> ResultKeeper::finish(const RunOutcome& outcome) {
  stop();
  auto written = write_results(outcome, path_, statements());
  if (written) {
    const std::lock_guard lock(mutex_);
    results_kept_ = outcome.results.size();
  }
  return written;
}

} // namespace dyncal::inline records
