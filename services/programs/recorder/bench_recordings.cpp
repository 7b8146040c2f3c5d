#include "services/programs/recorder/bench_recordings.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "services/contract/time_name.hpp"
#include "services/programs/recorder/recording_name.hpp"

namespace dyncal::inline programs {
namespace {

constexpr const char* all_benches = "*";
constexpr std::chrono::milliseconds max_wait{100};
constexpr std::size_t max_benches = 1000;

bool is_over(const wire::Measurement& measurement) {
  return measurement.state() == wire::MEASUREMENT_DONE ||
         measurement.state() == wire::MEASUREMENT_ABORTED;
}

} // namespace

Expected<std::unique_ptr<BenchRecordings>> BenchRecordings::create(bus::Participant& participant,
                                                                   RecordingPlan plan) {
  std::error_code problem;
  std::filesystem::create_directories(plan.folder, problem);
  if (problem) {
    return fail(ErrorCode::bad_file, fmt::format("{}: the folder cannot be made ({}); choose "
                                                 "another (--folder)",
                                                 plan.folder.string(), problem.message()));
  }
  std::unique_ptr<BenchRecordings> all(new BenchRecordings(participant, std::move(plan)));
  DYNCAL_TRY(auto descriptions,
             participant.reader(bus::topics::source_description, all_benches, all->wake_up_));
  DYNCAL_TRY(auto measurements,
             participant.reader(bus::topics::measurement, all_benches, all->wake_up_));
  DYNCAL_TRY(auto services,
             participant.reader(bus::topics::service_status, all_benches, all->wake_up_));
  all->readers_.emplace(
      Readers{std::move(descriptions), std::move(measurements), std::move(services)});
  for (const std::string& bench : all->plan_.benches) {
    all->benches_.try_emplace(bench);
  }
  return all;
}

bool BenchRecordings::is_wanted(const std::string& bench) const {
  return plan_.benches.empty() ? benches_.contains(bench) || benches_.size() < max_benches
                               : plan_.benches.contains(bench);
}

void BenchRecordings::take_messages() {
  readers_->descriptions.take([&](const wire::SourceDescription& description) {
    const std::string bench = description.bench().to_string();
    if (is_wanted(bench) && bus::check_bench_name(bench)) {
      benches_.try_emplace(bench);
    }
  });
  readers_->measurements.take([&](const wire::Measurement& measurement) { take(measurement); });
  readers_->services.take([&](const wire::ServiceStatus& status) { take(status); });
}

void BenchRecordings::take(const wire::Measurement& measurement) {
  const std::string name = measurement.bench().to_string();
  const std::string run = measurement.run().to_string();
  if (!is_wanted(name) || !bus::check_bench_name(name) || over_.contains({name, run})) {
    return;
  }
  Bench& bench = benches_[name];
  const Instant now = clock_.now();
  if (bench.run && bench.run->name == run) {
    bench.run->heard = now;
    if (is_over(measurement) && !bench.run->ends) {
      bench.run->ends = bench.run->give_up = now + end_limit;
    }
  } else if (!is_over(measurement)) {
    if (bench.run) {
      over_.insert({name, bench.run->name});
    }
    bench.run = Run{run, now, std::nullopt, std::nullopt};
  }
}

void BenchRecordings::take(const wire::ServiceStatus& status) {
  const auto bench = benches_.find(status.bench().to_string());
  if (bench == benches_.end() || !bench->second.run ||
      bench->second.run->name != status.run().to_string()) {
    return;
  }
  Run& run = *bench->second.run;
  const bool has_all = status.arm() == wire::ARM_FINISHED || status.arm() == wire::ARM_REFUSED;
  if (has_all && run.ends) {
    run.ends = std::min(*run.ends, clock_.now() + linger);
  }
}

void BenchRecordings::work() {
  clock_.wait(*wake_up_, clock_.now() + max_wait);
  take_messages();
  for (auto& [name, bench] : benches_) {
    choose_file(name, bench);
  }
}

// Whether there is nothing more to record of its run.
bool BenchRecordings::is_past(const Bench& bench, Instant now) {
  const Run& run = *bench.run;
  if (now - run.heard > silence_limit) {
    return true;
  }
  if (!run.ends || now <= *run.ends) {
    return false;
  }
  return now > *run.give_up || !bench.recorder || !bench.recorder->status().catches_up;
}

void BenchRecordings::choose_file(const std::string& name, Bench& bench) {
  const Instant now = clock_.now();
  if (bench.run && is_past(bench, now)) {
    over_.insert({name, bench.run->name});
    bench.run.reset();
  }
  const std::string run = bench.run ? bench.run->name : "";
  const bool is_large =
      run.empty() && bench.recorder && bench.recorder->status().file_bytes > plan_.max_file_bytes;
  if (bench.recorder && bench.recorded_run == run && !is_large) {
    return;
  }
  if (run.empty() && plan_.runs_only) {
    if (bench.recorder) {
      (void)end(name, bench);
    }
    return;
  }
  // The next one begins first: nothing is lost between the two.
  std::unique_ptr<recording::Recorder> old = std::move(bench.recorder);
  const std::string old_run = bench.recorded_run;
  begin(name, bench, run);
  if (old) {
    std::swap(old, bench.recorder);
    (void)end(name, bench);
    bench.recorder = std::move(old);
  }
}

void BenchRecordings::begin(const std::string& name, Bench& bench, const std::string& run) {
  bench.recorded_run = run;
  recording::RecorderOptions options = plan_.options;
  options.bench = name;
  options.run = run;
  options.path =
      recording_name(plan_.folder, name, run.empty() ? time_name(clock_.utc_now_ns()) : run);
  std::error_code problem;
  std::filesystem::create_directories(options.path.parent_path(), problem);
  auto recorder = recording::Recorder::start(participant_, std::move(options));
  if (!recorder) {
    spdlog::error("bench {}: not recorded: {}", name, recorder.error().message);
    return;
  }
  bench.recorder = std::move(*recorder);
  spdlog::info("bench {}{}: recording to {}", name, run.empty() ? "" : ", run " + run,
               bench.recorder->path().string());
}

Expected<void> BenchRecordings::end(const std::string& name, Bench& bench) {
  const std::filesystem::path path = bench.recorder->path();
  const auto ended = bench.recorder->stop();
  const recording::RecorderStatus status = bench.recorder->status();
  bench.recorder.reset();
  bench.before.stored += status.stored;
  bench.before.not_stored += status.not_stored;
  bench.before.missing += status.missing;
  if (!ended) {
    spdlog::error("bench {}: {}", name, ended.error().message);
    return fail(ended.error());
  }
  spdlog::info("bench {}: {} has {} messages, {:.1f} MB; {} not stored, {} never came", name,
               path.string(), status.stored, static_cast<double>(status.file_bytes) / 1e6,
               status.not_stored, status.missing);
  if (status.catches_up) {
    spdlog::warn("bench {}: {} ended before its sources had given again what it missed; it may "
                 "lack the beginning of its run, or parts of it",
                 name, path.string());
  }
  return {};
}

std::vector<RecorderFigures> BenchRecordings::figures() const {
  std::vector<RecorderFigures> all;
  for (const auto& [name, bench] : benches_) {
    const auto now = bench.recorder ? bench.recorder->status() : recording::RecorderStatus{};
    all.push_back({.bench = name,
                   .stored = bench.before.stored + now.stored,
                   .not_stored = bench.before.not_stored + now.not_stored,
                   .missing = bench.before.missing + now.missing,
                   .file_bytes = now.file_bytes,
                   .free_bytes = now.free_bytes,
                   .records = bench.recorder && !now.ended});
  }
  return all;
}

Expected<void> BenchRecordings::stop() {
  Expected<void> outcome;
  for (auto& [name, bench] : benches_) {
    if (bench.recorder) {
      if (auto ended = end(name, bench); !ended && outcome) {
        outcome = std::move(ended);
      }
    }
  }
  return outcome;
}

} // namespace dyncal::inline programs
