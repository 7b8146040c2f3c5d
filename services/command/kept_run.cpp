#include "services/command/kept_run.hpp"

#include <utility>

#include <fmt/format.h>

#include "services/bench/named_files.hpp"
#include "services/command/run_command.hpp"
#include "services/store/store.hpp"

namespace dyncal::services {
namespace {

Expected<std::unique_ptr<RunFolder>> folder_of(const std::filesystem::path& root,
                                               const BenchFile& bench, const KeptRunSetup& setup) {
  if (setup.is_resumed) {
    auto begun = RunFolder::reopen(root, bench, setup.run);
    if (!begun || *begun) {
      return begun;
    }
  }
  const std::string now = run_from_time();
  const std::string name =
      is_run_from_time(setup.run) ? setup.run : run_folder_name(setup.run, now);
  return RunFolder::create(root, bench, name);
}

std::string line_of(const RunProgress& progress) {
  if (!progress.notice.empty()) {
    return progress.notice;
  }
  if (!progress.request.empty()) {
    return progress.request;
  }
  if (progress.step == 0) {
    return progress.phase;
  }
  return fmt::format("step {} of {}, {} Hz, {}{}", progress.step, progress.steps,
                     progress.frequency_hz, progress.phase,
                     progress.attempt > 1 ? fmt::format(", attempt {}", progress.attempt) : "");
}

} // namespace

KeptRun::KeptRun(KeepOptions options, const BenchFile& bench, KeptRunSetup setup,
                 std::unique_ptr<RunFolder> folder, std::optional<LogFile> log,
                 std::optional<RateReader> rates)
    : options_(std::move(options)), bench_(bench), setup_(std::move(setup)),
      folder_(std::move(folder)), log_(std::move(log)), rates_(std::move(rates)) {}

Expected<std::unique_ptr<KeptRun>> KeptRun::open(const KeepOptions& options, const BenchFile& bench,
                                                 KeptRunSetup setup,
                                                 bus::Participant& participant) {
  if (!options.folder) {
    return std::unique_ptr<KeptRun>(
        new KeptRun(options, bench, std::move(setup), nullptr, std::nullopt, std::nullopt));
  }
  auto folder = folder_of(*options.folder, bench, setup);
  if (!folder) {
    return fail(folder.error());
  }
  auto log = LogFile::open((*folder)->path() / log_file_name);
  auto rates =
      participant.reader(bus::topics::source_status, bench.bench, std::make_shared<bus::WakeUp>());
  if (auto error = first_error(log, rates)) {
    (*folder)->discard();
    return fail(std::move(*error));
  }
  log->write(fmt::format("bench '{}', run '{}', bench file {}", bench.bench, setup.run,
                         std::filesystem::absolute(bench.path).string()));
  return std::unique_ptr<KeptRun>(new KeptRun(options, bench, std::move(setup), std::move(*folder),
                                              std::move(*log), std::move(*rates)));
}

RunKeeping KeptRun::keeping() {
  if (!folder_) {
    return {};
  }
  return {.check = [this](const RunOutcome& planned) { return check(planned); },
          .keep = [this](const RunOutcome& so_far) { folder_->results().keep(completed(so_far)); }};
}

Expected<void> KeptRun::check(const RunOutcome& planned) {
  std::map<std::string, double> rates_hz;
  rates_->take([&](const wire::SourceStatus& status) {
    rates_hz[status.source().to_string()] = status.rate_hz();
  });
  const SpaceEstimate need = estimate_space(planned, bench_, rates_hz, false);
  if (auto room = folder_->check_room(need); !room) {
    return room;
  }
  say(fmt::format("run folder {}; the run needs about {} there, {} are free",
                  folder_->path().string(), size_text(need.bytes()),
                  size_text(folder_->free_bytes())));
  return folder_->results().begin(completed(planned));
}

RunOutcome KeptRun::completed(RunOutcome so_far) const {
  so_far.adc_file = setup_.adc_file;
  return so_far;
}

void KeptRun::note(const RunProgress& progress) {
  if (!folder_) {
    return;
  }
  note_kept();
  const std::string line = line_of(progress);
  if (!line.empty() && line != last_line_) {
    log_->write(line);
    last_line_ = line;
  }
}

// After the file is on the disk, so that no line promises what a kill could take.
void KeptRun::note_kept() {
  const std::size_t kept = folder_->results().results_kept();
  if (kept != noted_results_) {
    noted_results_ = kept;
    log_->write(fmt::format("{} results are in {}", kept, result_file_name));
  }
  const auto problem = folder_->results().problem();
  if (problem && !noted_problem_) {
    say(fmt::format("{}; the run goes on, its results are tried again with every step",
                    problem->message));
  }
  noted_problem_ = problem.has_value();
}

void KeptRun::say(const std::string& sentence) {
  log_->write(sentence);
  setup_.notice(sentence);
}

std::optional<std::filesystem::path> KeptRun::folder() const {
  return folder_ ? std::optional(folder_->path()) : std::nullopt;
}

Expected<void> KeptRun::finish(const RunOutcome& outcome) {
  if (!folder_) {
    return {};
  }
  const auto written = folder_->finish(outcome);
  log_->write(
      written ? fmt::format("ended, {} results are in {}", outcome.results.size(), result_file_name)
              : written.error().message);
  if (!written) {
    return written;
  }
  add_to_store(outcome);
  return {};
}

void KeptRun::add_to_store(const RunOutcome& outcome) {
  const std::string place = store_place(options_.store, *options_.folder);
  if (place.empty()) {
    return;
  }
  auto added = Store::open(place).and_then(
      [&](std::unique_ptr<Store> store) { return store->add(folder_->path()); });
  if (!added) {
    say(fmt::format("run '{}' is not in the store ({}); all of it is in its folder: add it with "
                    "'dyncal store add {}'",
                    outcome.run, added.error().message, folder_->path().string()));
  }
}

void KeptRun::discard() {
  if (folder_) {
    log_.reset();
    folder_->discard();
    folder_.reset();
  }
}

} // namespace dyncal::services
