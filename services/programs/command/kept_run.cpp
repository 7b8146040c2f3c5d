#include "services/programs/command/kept_run.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "services/base/printable_text.hpp"
#include "services/bench/file/named_files.hpp"
#include "services/contract/run_identity.hpp"
#include "services/programs/command/own_recording.hpp"
#include "services/programs/command/progress_line.hpp"
#include "services/records/capture/recorder.hpp"
#include "services/records/store/store.hpp"
#include "services/views/report/run_journal.hpp"
#include "services/views/report/show_outcome.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline programs {
namespace {

Expected<std::unique_ptr<RunFolder>> folder_of(const std::filesystem::path& root,
                                               const BenchFile& bench, const KeptRunSetup& setup) {
  if (setup.is_resumed) {
    auto begun = RunFolder::reopen(root, bench, setup.run);
    if (!begun || *begun) {
      return begun;
    }
  }
  return RunFolder::create(root, bench, safe_name(setup.run));
}

Expected<std::unique_ptr<recording::Recorder>> start_recorder(const RunFolder& folder,
                                                              const BenchFile& bench,
                                                              const KeptRunSetup& setup,
                                                              bus::Participant& participant) {
  recording::RecorderOptions options;
  options.path = folder.recording_path();
  options.bench = bench.bench;
  options.run = setup.run;
  options.dds = setup.dds;
  options.domain = setup.domain;
  return recording::Recorder::start(participant, std::move(options));
}

// As its result file has it; nothing where that cannot be read: then the analysis alone knows.
std::optional<BegunRun> begun_run(const std::filesystem::path& folder) {
  const auto result = read_result(folder);
  if (!result) {
    return std::nullopt;
  }
  return BegunRun{result->recipe_sha256, result->sources, !result->points.empty()};
}

// A run that is resumed stays that of who began it.
RunStatements statements_of(const KeptRunSetup& setup, const std::filesystem::path& folder) {
  RunStatements stated;
  if (const auto begun = read_result(folder); setup.is_resumed && begun) {
    stated = *begun;
  }
  stated.conducted_by = stated.conducted_by.value_or(setup.conducted_by);
  stated.comment = stated.comment.empty() ? setup.comment : stated.comment;
  stated.sensor = stated.sensor.empty() ? setup.sensor : stated.sensor;
  return stated;
}

std::string line_of(const RunProgress& progress) {
  if (!progress.notice.empty()) {
    return progress.notice;
  }
  if (!progress.request.empty()) {
    return progress.request;
  }
  return progress.step == 0 ? progress.phase : step_text(progress);
}

} // namespace

KeptRun::KeptRun(KeepOptions options, const BenchFile& bench, KeptRunSetup setup,
                 std::optional<Disk> disk, bus::Participant& participant)
    : options_(std::move(options)), bench_(bench), setup_(std::move(setup)), disk_(std::move(disk)),
      participant_(participant),
      stated_(statements_of(setup_, disk_ ? disk_->folder->path() : std::filesystem::path())),
      conditions_before_(stated_.conditions) {
  if (disk_) {
    disk_->folder->results().set_statements(stated_);
  }
}

KeptRun::~KeptRun() = default;

Expected<std::unique_ptr<KeptRun>> KeptRun::open(const KeepOptions& options, const BenchFile& bench,
                                                 KeptRunSetup setup,
                                                 bus::Participant& participant) {
  if (!options.folder) {
    return std::unique_ptr<KeptRun>(
        new KeptRun(options, bench, std::move(setup), std::nullopt, participant));
  }
  DYNCAL_TRY(auto folder, folder_of(*options.folder, bench, setup));
  auto log = LogFile::open(folder->path() / log_file_name);
  auto rates =
      participant.reader(bus::topics::source_status, bench.bench, std::make_shared<bus::WakeUp>());
  auto recorder = options.recording ? start_recorder(*folder, bench, setup, participant)
                                    : Expected<std::unique_ptr<recording::Recorder>>{};
  if (auto error = first_error(log, rates, recorder)) {
    if (recorder) {
      recorder->reset();
    }
    folder->discard();
    return fail(std::move(*error));
  }
  log->write(fmt::format("bench '{}', run '{}', bench file {}, conducted by {}", bench.bench,
                         setup.run, std::filesystem::absolute(bench.path).string(),
                         text_of(setup.conducted_by)));
  return std::unique_ptr<KeptRun>(
      new KeptRun(options, bench, std::move(setup),
                  Disk{std::move(folder), std::move(*log), std::move(*rates), std::move(*recorder)},
                  participant));
}

RunKeeping KeptRun::keeping() {
  if (!disk_) {
    return {};
  }
  return {
      .check = [this](const RunOutcome& planned) { return check(planned); },
      .keep =
          [this](const RunOutcome& so_far) { disk_->folder->results().keep(completed(so_far)); },
      .begun = setup_.is_resumed ? begun_run(disk_->folder->path()) : std::nullopt};
}

Expected<void> KeptRun::check(const RunOutcome& planned) {
  std::map<std::string, double> rates_hz;
  disk_->rates.take([&](const wire::SourceStatus& status) {
    rates_hz[status.source().to_string()] = status.rate_hz();
  });
  SpaceEstimate need = estimate_space(planned, bench_, rates_hz, disk_->recorder != nullptr);
  if (disk_->recorder) {
    need.recording_bytes += recording::RecorderOptions{}.min_free_bytes; // it ends with less
  }
  DYNCAL_TRY(disk_->folder->check_room(need));
  say(fmt::format("run folder {}; the run needs about {} there, {} are free",
                  disk_->folder->path().string(), size_text(need.bytes()),
                  size_text(disk_->folder->free_bytes())));
  if (auto settings = condition_settings_of(bench_.text)) {
    conditions_ =
        std::make_unique<ConditionLogger>(std::move(*settings), bench_, planned, participant_,
                                          disk_->folder->path() / "conditions.csv");
  }
  return disk_->folder->results().begin(completed(planned));
}

void KeptRun::set_check(const DailyCheck& check) {
  stated_.check = check;
  if (disk_) {
    disk_->folder->results().set_statements(stated_);
    say(sentence_of(check));
  }
}

RunOutcome KeptRun::completed(RunOutcome so_far) const {
  so_far.adc_file = setup_.adc_file;
  return so_far;
}

void KeptRun::note(const RunProgress& progress) {
  if (!disk_) {
    return;
  }
  note_kept();
  note_recording();
  note_conditions();
  const std::string line = line_of(progress);
  if (line.empty() || line == last_line_) {
    return;
  }
  disk_->log.write(line);
  last_line_ = line;
  if (!progress.notice.empty()) {
    note_event(progress.notice);
  }
}

void KeptRun::note_event(const std::string& sentence) {
  const auto kept =
      append_to_journal(disk_->folder->path(),
                        journal_entry(JournalKind::event, one_line(sentence), setup_.conducted_by));
  if (!kept) {
    say(kept.error().message);
  }
}

void KeptRun::note_conditions() {
  if (!conditions_) {
    return;
  }
  for (const std::string& sentence : conditions_->take_sentences()) {
    say(sentence);
    note_event(sentence);
  }
  auto logged = joined_conditions(conditions_before_, conditions_->logged());
  if (!std::ranges::equal(logged, stated_.conditions, {}, &LoggedCondition::count,
                          &LoggedCondition::count)) {
    stated_.conditions = std::move(logged);
    disk_->folder->results().set_statements(stated_);
  }
}

// After the file is on the disk, so that no line promises what a kill could take.
void KeptRun::note_kept() {
  const std::size_t kept = disk_->folder->results().results_kept();
  if (kept != noted_results_) {
    noted_results_ = kept;
    disk_->log.write(fmt::format("{} results are in {}", kept, result_file_name));
  }
  const auto problem = disk_->folder->results().problem();
  if (problem && !noted_problem_) {
    say(fmt::format("{}; the run goes on, its results are tried again with every step",
                    problem->message));
  }
  noted_problem_ = problem.has_value();
}

// The run goes on: its results come without it.
void KeptRun::note_recording() {
  if (!disk_->recorder || noted_end_of_recording_) {
    return;
  }
  const recording::RecorderStatus status = disk_->recorder->status();
  if (status.ended && !status.problem.empty()) {
    noted_end_of_recording_ = true;
    say(fmt::format("THE RUN IS NOT RECORDED ANY MORE: {}", status.problem));
  }
}

void KeptRun::end_recording() {
  if (!disk_->recorder) {
    return;
  }
  const auto ended = disk_->recorder->stop();
  if (!ended) {
    say(fmt::format("the recording is not whole: {}", ended.error().message));
  } else if (ended->not_stored > 0 || ended->missing > 0) {
    say(fmt::format("the recording is not whole: {} messages were not stored, {} blocks of samples "
                    "never came",
                    ended->not_stored, ended->missing));
  } else {
    is_recorded_whole_ = true;
    disk_->log.write(fmt::format("the recording has {} messages, {}", ended->stored,
                                 size_text(ended->file_bytes)));
  }
}

void KeptRun::say(const std::string& sentence) {
  disk_->log.write(sentence);
  setup_.notice(sentence);
}

std::optional<std::filesystem::path> KeptRun::folder() const {
  return disk_ ? std::optional(disk_->folder->path()) : std::nullopt;
}

Expected<void> KeptRun::finish(const RunOutcome& outcome) {
  if (!disk_) {
    return {};
  }
  end_recording();
  if (conditions_) {
    stated_.conditions = joined_conditions(conditions_before_, conditions_->finish());
    disk_->folder->results().set_statements(stated_);
    note_conditions(); // its last sentences
  }
  const auto written = disk_->folder->finish(outcome);
  disk_->log.write(
      written ? fmt::format("ended, {} results are in {}", outcome.results.size(), result_file_name)
              : written.error().message);
  return written;
}

void KeptRun::add_to_store(const RunOutcome& outcome) {
  if (!disk_) {
    return;
  }
  const std::string place = store_place(options_.store, *options_.folder);
  if (place.empty()) {
    return;
  }
  auto added = Store::open(place).and_then([&](std::unique_ptr<Store> store) {
    return store->add(disk_->folder->path(), setup_.conducted_by);
  });
  if (!added) {
    say(fmt::format("run '{}' is not in the store ({}); all of it is in its folder: add it with "
                    "'dyncal store add {}'",
                    outcome.run, added.error().message, disk_->folder->path().string()));
  }
}

Expected<void> KeptRun::hold_against_recording(const RunOutcome& outcome,
                                               const std::stop_token& stop) {
  if (!disk_) {
    return {};
  }
  if (!disk_->recorder) {
    say(not_held("there is none"));
    return {};
  }
  if (!check_complete(outcome)) { // a step that was broken off has no end to agree on
    say(not_held("the run is not whole"));
    return {};
  }
  const OwnRecordingCheck check = check_own_recording(
      outcome, disk_->folder->path(), setup_.is_resumed || !is_recorded_whole_, stop);
  if (check.differs) {
    disk_->log.write(check.sentence);
    return fail(ErrorCode::no_result, check.sentence);
  }
  say(check.sentence);
  return {};
}

void KeptRun::log(const std::string& sentence) {
  if (disk_) {
    disk_->log.write(sentence);
  }
}

void KeptRun::discard() {
  if (disk_) {
    conditions_.reset();
    disk_->recorder.reset();
    disk_->folder->discard();
    disk_.reset();
  }
}

} // namespace dyncal::inline programs
