#include "services/records/store/store.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "services/base/per_enumerator.hpp"
#include "services/records/store/migrations.hpp"
#include "services/records/store/result_rows.hpp"
#include "services/views/report/amendments.hpp"
#include "services/views/report/mean_check.hpp"

namespace dyncal::inline records {
namespace {

// What `dyncal analyse` calls a run of files: the name says nothing, the time of the records does.
constexpr const char* run_of_files = "files";

StoredRun run_of(const DatabaseRow& row) {
  return {.bench = text_of(row[0]),
          .run = text_of(row[1]),
          .state = text_of(row[2]),
          .began_utc = text_of(row[3]),
          .ended_utc = text_of(row[4]),
          .method = text_of(row[5]),
          .software = text_of(row[6]),
          .recipe_sha256 = text_of(row[7]),
          .result_sha256 = text_of(row[8]),
          .planned_steps = integer_of(row[9]),
          .measured_steps = integer_of(row[10]),
          .problem = text_of(row[11]),
          .folder = text_of(row[12]),
          .conducted_by = text_of(row[13]),
          .sources = {}};
}

constexpr const char* select_runs =
    "SELECT bench, run, state, began_utc, ended_utc, method, software, recipe_sha256, "
    "result_sha256, planned_steps, measured_steps, problem, folder, operator FROM results "
    "ORDER BY began_utc, added_utc, result_sha256";

bool is_sensor(const RunSource& source, const std::string& sensor) {
  return source.description.serial == sensor || source.description.device == sensor ||
         source.source == sensor;
}

// Of texts "2026-11-22T10:15:30.125Z", compared as far as the filter goes.
bool is_within(const std::string& began_utc, const RunFilter& filter) {
  return (filter.since.empty() || began_utc >= filter.since) &&
         (filter.until.empty() || began_utc.substr(0, filter.until.size()) <= filter.until);
}

bool passes(const StoredRun& run, const RunFilter& filter) {
  const bool has_sensor =
      filter.sensor.empty() ||
      std::any_of(run.sources.begin(), run.sources.end(),
                  [&](const RunSource& source) { return is_sensor(source, filter.sensor); });
  return has_sensor && is_within(run.began_utc, filter) &&
         (filter.bench.empty() || run.bench == filter.bench) &&
         (filter.state.empty() || run.state == filter.state);
}

// Of "samples_lost,over_range".
std::vector<std::string> names_in(const std::string& text) {
  std::vector<std::string> names;
  std::istringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');) {
    names.push_back(std::move(name));
  }
  return names;
}

Error other_result(const ResultRecord& record, const DatabaseRow& known) {
  return {
      ErrorCode::bad_file,
      fmt::format("{}: the store has another result of run '{}' of bench '{}' by the same "
                  "recipe: {} from {}, this one is {}; a result is not replaced: find out which "
                  "is right",
                  record.folder, record.result.run, record.result.bench,
                  text_of(known[0]).substr(0, 12), text_of(known[4]),
                  record.result.sha256.substr(0, 12))};
}

} // namespace

std::string store_place(const std::string& option, const std::filesystem::path& runs_folder) {
  if (option == "none") {
    return "";
  }
  return option.empty() ? (runs_folder / "dyncal.sqlite").string() : option;
}

Expected<std::unique_ptr<Store>> Store::open(const std::string& place) {
  DYNCAL_TRY(auto database, open_migrated(place));
  return std::unique_ptr<Store>(new Store(std::move(database)));
}

Expected<std::unique_ptr<Store>> Store::open_existing(const std::string& place) {
  if (!is_server(place) && !std::filesystem::exists(place)) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: there is no store yet; 'dyncal run' makes it, or 'dyncal store "
                            "add'; name another with --store",
                            place));
  }
  return open(place);
}

Expected<StoreAddition> Store::add(const std::filesystem::path& path, const ActingPerson& by) {
  DYNCAL_TRY(const auto record, read_result_record(path));
  DYNCAL_TRY(check_means(record.result));
  std::error_code unknown;
  std::vector<JournalEntry> entries;
  if (std::filesystem::is_directory(path, unknown)) {
    DYNCAL_TRY(entries, read_journal(path));
  }
  StoreAddition addition = StoreAddition::added;
  const auto written = database_->transaction([&]() -> Expected<void> {
    DYNCAL_TRY(addition, add_result(record, by));
    return insert_entries(*database_, record.result.bench, record.result.run, entries, by);
  });
  DYNCAL_TRY(written);
  return addition;
}

Expected<StoreAddition> Store::add_result(const ResultRecord& record, const ActingPerson& by) {
  DYNCAL_TRY(const auto addition, make_way(record, by));
  if (addition == StoreAddition::already_there) {
    return addition;
  }
  DYNCAL_TRY(insert_result(*database_, record));
  DYNCAL_TRY(
      add_to_audit(*database_,
                   {AuditAction::result_added, record.result.sha256,
                    fmt::format("result of run {} of bench {} ({}), {}", record.result.run,
                                record.result.bench, to_string(record.state), record.folder)},
                   by));
  return addition;
}

// A run of files is known by its time as well: its name says nothing.
Expected<std::optional<KeptHash>> Store::hash_of(const StoredResult& result) {
  DYNCAL_TRY(const auto rows,
             database_->execute("SELECT result_sha256, state, began_utc, added_utc FROM results "
                                "WHERE bench = $1 AND run = $2 AND recipe_sha256 = $3",
                                {result.bench, result.run, result.recipe_sha256}));
  std::optional<KeptHash> hash;
  for (const DatabaseRow& row : rows) {
    const bool is_of_other_files =
        result.run == run_of_files && text_of(row[2]) != result.began_utc;
    const KeptHash kept{text_of(row[0]), text_of(row[3])};
    if (kept.sha256 == result.sha256) {
      return std::optional(kept);
    }
    if (!is_of_other_files && text_of(row[1]) != to_string(RunCompletion::unfinished)) {
      hash = kept;
    }
  }
  return hash;
}

// What becomes of the record, beside those of its run that are there.
Expected<StoreAddition> Store::make_way(const ResultRecord& record, const ActingPerson& by) {
  const StoredResult& result = record.result;
  DYNCAL_TRY(const auto rows,
             database_->execute(
                 "SELECT result_sha256, content_sha256, recipe_sha256, state, folder, began_utc "
                 "FROM results WHERE bench = $1 AND run = $2",
                 {result.bench, result.run}));
  for (const DatabaseRow& row : rows) {
    if (text_of(row[0]) == result.sha256 || text_of(row[1]) == result.content_sha256) {
      return StoreAddition::already_there;
    }
  }
  for (const DatabaseRow& row : rows) {
    const bool other_files = result.run == run_of_files && text_of(row[5]) != result.began_utc;
    if (text_of(row[2]) != result.recipe_sha256 || other_files) {
      continue;
    }
    if (text_of(row[3]) != to_string(RunCompletion::unfinished)) {
      return fail(other_result(record, row));
    }
    DYNCAL_TRY(remove_result(*database_, text_of(row[0])));
    DYNCAL_TRY(add_to_audit(
        *database_,
        {AuditAction::result_removed, text_of(row[0]),
         fmt::format("result of run {} of bench {} before it had ended", result.run, result.bench)},
        by));
    return StoreAddition::replaced_unfinished;
  }
  return StoreAddition::added;
}

Expected<std::vector<StoredRun>> Store::runs(const RunFilter& filter,
                                             const SharedWorkCount& count) {
  DYNCAL_TRY(const auto rows, database_->execute(select_runs));
  begin_work(count, "looking through the store", "runs", rows.size());
  std::vector<StoredRun> found;
  for (const DatabaseRow& row : rows) {
    StoredRun run = run_of(row);
    DYNCAL_TRY(run.sources, sources_of(run.result_sha256));
    found.push_back(std::move(run));
    add_done(count);
  }
  DYNCAL_TRY(amend(found));
  std::erase_if(found, [&](const StoredRun& run) { return !passes(run, filter); });
  return found;
}

Expected<void> Store::add_entries(const std::string& bench, const std::string& run,
                                  const std::vector<JournalEntry>& entries,
                                  const ActingPerson& by) {
  return database_->transaction(
      [&] { return insert_entries(*database_, bench, run, entries, by); });
}

// As the journals of the runs correct them.
Expected<void> Store::amend(std::vector<StoredRun>& runs) {
  DYNCAL_TRY(const auto journals, amendments_by_run(*database_));
  for (StoredRun& run : runs) {
    const auto journal = journals.find({run.bench, run.run});
    if (journal != journals.end()) {
      amend_sources(journal->second, run.sources);
      run.conducted_by = amended(journal->second, "operator").value_or(run.conducted_by);
      run.amendments = amendment_sentences(journal->second);
    }
  }
  return {};
}

Expected<std::vector<RunSource>> Store::sources_of(const std::string& result_sha256) {
  DYNCAL_TRY(
      const auto rows,
      database_->execute(
          "SELECT source, device, serial, firmware, software FROM sources WHERE result_sha256 = $1 "
          "ORDER BY source",
          {result_sha256}));
  std::vector<RunSource> sources;
  for (const DatabaseRow& row : rows) {
    RunSource source{.source = text_of(row[0]), .software = text_of(row[4]), .description = {}};
    source.description.device = text_of(row[1]);
    source.description.serial = text_of(row[2]);
    source.description.firmware = text_of(row[3]);
    sources.push_back(std::move(source));
  }
  return sources;
}

Expected<std::vector<StoredValue>> Store::points_of(const std::string& result_sha256,
                                                    const std::string& source) {
  DYNCAL_TRY(
      const auto rows,
      database_->execute(
          "SELECT channel, frequency_text_hz, frequency_hz, level_m_s2, unit, magnitude, "
          "u_magnitude, "
          "k_magnitude, expanded_magnitude, phase_rad, u_phase_rad, k_phase, expanded_phase_rad, "
          "flags, excited_axis "
          "FROM points WHERE result_sha256 = $1 AND source = $2 "
          "ORDER BY channel, frequency_hz, level_m_s2",
          {result_sha256, source}));
  std::vector<StoredValue> points;
  for (const DatabaseRow& row : rows) {
    StoredValue point;
    point.unwrapped_phase_rad = nan("");
    point.channel = text_of(row[0]);
    point.frequency_text_hz = text_of(row[1]);
    point.frequency_hz = number_of(row[2]);
    point.level_m_s2 = number_of(row[3]);
    point.unit = text_of(row[4]);
    point.magnitude = number_of(row[5]);
    point.phase_rad = number_of(row[9]);
    point.of_magnitude = {
        .u = number_of(row[6]), .k = number_of(row[7]), .expanded = number_of(row[8])};
    point.of_phase = {
        .u = number_of(row[10]), .k = number_of(row[11]), .expanded = number_of(row[12])};
    point.flag_names = names_in(text_of(row[13]));
    point.excited_axis = text_of(row[14]);
    points.push_back(std::move(point));
  }
  return points;
}

Expected<std::vector<OpenClosure>> Store::open_closures_of(const std::string& result_sha256,
                                                           const std::string& source) {
  DYNCAL_TRY(const auto rows, database_->execute("SELECT channel, kind, sentence FROM closures "
                                                 "WHERE result_sha256 = $1 AND source = $2 AND "
                                                 "verdict = 'open' ORDER BY channel, kind",
                                                 {result_sha256, source}));
  std::vector<OpenClosure> all;
  for (const DatabaseRow& row : rows) {
    if (const auto kind = parse_enumerator<ClosureKind>(text_of(row[1]))) {
      const Closure closure{.kind = *kind, .verdict = Verdict::open, .sentence = text_of(row[2])};
      all.push_back({text_of(row[0]), closure_line(text_of(row[0]), closure)});
    }
  }
  return all;
}

Expected<std::vector<Calibration>> Store::calibrations(const std::string& sensor,
                                                       const SharedWorkCount& count) {
  DYNCAL_TRY(auto runs_with_sensor, runs({.sensor = sensor}, count));
  begin_work(count, "reading", "calibrations", runs_with_sensor.size());
  std::vector<Calibration> calibrations;
  for (const StoredRun& run : runs_with_sensor) {
    for (const RunSource& source : run.sources) {
      DYNCAL_TRY(auto points, is_sensor(source, sensor)
                                  ? points_of(run.result_sha256, source.source)
                                  : Expected<std::vector<StoredValue>>{});
      if (!points.empty()) {
        DYNCAL_TRY(auto open, open_closures_of(run.result_sha256, source.source));
        calibrations.push_back({run, source.source, std::move(points), std::move(open)});
      }
    }
    add_done(count);
  }
  return calibrations;
}

Expected<std::vector<std::string>> Store::sensors() {
  DYNCAL_TRY(const auto rows,
             database_->execute("SELECT DISTINCT CASE WHEN serial = '' THEN device ELSE serial END "
                                "FROM sources WHERE EXISTS (SELECT 1 FROM points WHERE "
                                "points.result_sha256 = sources.result_sha256 AND "
                                "points.source = sources.source) ORDER BY 1"));
  std::vector<std::string> sensors;
  std::ranges::transform(rows, std::back_inserter(sensors),
                         [](const DatabaseRow& row) { return text_of(row[0]); });
  return sensors;
}

Expected<void> Store::add_common_parts(std::vector<Calibration>& calibrations,
                                       const SharedWorkCount& count) {
  begin_work(count, "reading budgets", "calibrations", calibrations.size());
  for (Calibration& calibration : calibrations) {
    DYNCAL_TRY(const auto rows,
               database_->execute("SELECT document FROM results WHERE result_sha256 = $1",
                                  {calibration.run.result_sha256}));
    ByteCount no_progress;
    // What an older version wrote and this one cannot read shares nothing.
    const auto result = result_of_text(rows.empty() ? "" : text_of(rows[0][0]),
                                       calibration.run.folder, no_progress);
    if (result) {
      calibration.common = common_parts_of(*result, calibration.source);
    }
    add_done(count);
  }
  return {};
}

} // namespace dyncal::inline records
