#include "services/instruments/table_source.hpp"

#include <condition_variable>
#include <mutex>
#include <utility>

#include <fmt/core.h>

#include "drivers/tables/table_files.hpp"
#include "drivers/utc_clock.hpp"
#include "services/instruments/reference_steps.hpp"

namespace dyncal::inline instruments {
namespace {

using namespace std::chrono_literals;

constexpr auto look_interval = 250ms;
constexpr auto show_interval = 1s;

} // namespace

Expected<TableSource> TableSource::prepare(const SourceSettings& settings) {
  DYNCAL_TRY(TableWatch::begin(settings, {}, {})); // what stands there can be read
  return TableSource(settings);
}

Expected<void> TableSource::run(SourcePublisher& publisher, const std::stop_token& stop) {
  publisher.describe(describe_table(settings_));
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  while (!stop.stop_requested()) {
    turn(publisher, std::chrono::steady_clock::now());
    stopped.wait_for(lock, stop, look_interval, [] { return false; });
  }
  publisher.end();
  return {};
}

void TableSource::turn(SourcePublisher& publisher, Instant now) {
  if (now - shown_ >= show_interval) {
    drivers::SampleBlock nothing;
    nothing.received_utc_ns = utc_now_ns();
    publisher.take(std::move(nothing));
    shown_ = now;
  }
  const auto heard = publisher.heard_run();
  if (heard && heard->is_under_way && heard->run != run_) {
    begin(publisher, *heard, now);
  }
  if (heard && watch_ && heard->run == run_) {
    look(publisher, !heard->is_under_way, now);
  }
}

void TableSource::begin(SourcePublisher& publisher, const HeardRun& run, Instant now) {
  watch_.reset();
  said_.clear();
  if (run.is_running && !run.is_answered) {
    run_ = run.run;
    say(publisher,
        fmt::format("its service was started in the middle of run {}, and cannot tell which rows "
                    "of the table are of it: its steps have no value from now on; evaluate it with "
                    "'dyncal analyse'",
                    run.run));
    return;
  }
  auto watch = TableWatch::begin(settings_, run.steps, now);
  if (!watch) {
    say(publisher, watch.error().message); // and it is tried again
    return;
  }
  run_ = run.run;
  watch_.emplace(*std::move(watch));
  say(publisher, "");
}

void TableSource::look(SourcePublisher& publisher, bool run_is_over, Instant now) {
  if (watch_->is_finished(now)) {
    return;
  }
  auto news = watch_->look(now, run_is_over);
  if (!news) {
    say(publisher, news.error().message);
    return;
  }
  for (ReferenceStep& step : news->steps) {
    publisher.hand_out({run_, std::move(step)});
  }
  for (const std::string& sentence : news->sentences) {
    said_ += (said_.empty() ? "" : "; ") + sentence;
  }
  say(publisher, said_);
}

void TableSource::say(SourcePublisher& publisher, std::string problem) {
  if (problem == problem_) {
    return;
  }
  if (!problem.empty()) {
    publisher.warn(problem);
  }
  publisher.set_message(problem);
  problem_ = std::move(problem);
}

} // namespace dyncal::inline instruments
