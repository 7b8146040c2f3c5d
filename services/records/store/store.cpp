#include "services/records/store/store.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <iterator>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/per_enumerator.hpp"
#include "services/records/store/migrations.hpp"
#include "services/views/report/mean_check.hpp"

namespace dyncal::inline records {
namespace {

// What `dyncal analyse` calls a run of files: the name says nothing, the time of the records does.
constexpr const char* run_of_files = "files";

std::string now_utc() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text.data();
}

// The store knows no NaN.
DatabaseValue value(double number) {
  return number == number ? DatabaseValue(number) : DatabaseValue(std::monostate{});
}

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
          .sources = {}};
}

constexpr const char* select_runs =
    "SELECT bench, run, state, began_utc, ended_utc, method, software, recipe_sha256, "
    "result_sha256, planned_steps, measured_steps, problem, folder FROM results "
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

std::string source_of(const std::string& channel) {
  return channel.substr(0, channel.find('/'));
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

Expected<StoreAddition> Store::add(const std::filesystem::path& path) {
  DYNCAL_TRY(const auto record, read_result_record(path));
  DYNCAL_TRY(check_means(record.result));
  StoreAddition addition = StoreAddition::added;
  const auto written = database_->transaction([&]() -> Expected<void> {
    DYNCAL_TRY(addition, make_way(record));
    return addition == StoreAddition::already_there ? Expected<void>{} : insert(record);
  });
  DYNCAL_TRY(written);
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
Expected<StoreAddition> Store::make_way(const ResultRecord& record) {
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
    DYNCAL_TRY(remove(text_of(row[0])));
    return StoreAddition::replaced_unfinished;
  }
  return StoreAddition::added;
}

Expected<void> Store::insert(const ResultRecord& record) {
  const StoredResult& result = record.result;
  const auto done = database_->execute(
      "INSERT INTO results (result_sha256, content_sha256, recipe_sha256, bench, run, state, "
      "method, began_utc, ended_utc, software, planned_steps, measured_steps, problem, recipe, "
      "folder, added_utc, document) "
      "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17)",
      {result.sha256, result.content_sha256, result.recipe_sha256, result.bench, result.run,
       to_string(record.state), result.method, result.began_utc, result.ended_utc, result.software,
       std::int64_t{result.planned_steps}, record.measured_steps, result.problem, result.recipe,
       record.folder, now_utc(), record.document});
  DYNCAL_TRY(done);
  for (const RunSource& source : result.sources) {
    const auto inserted = database_->execute(
        "INSERT INTO sources (result_sha256, source, device, serial, firmware, software) "
        "VALUES ($1, $2, $3, $4, $5, $6)",
        {result.sha256, source.source, source.description.device, source.description.serial,
         source.description.firmware, source.software});
    DYNCAL_TRY(inserted);
  }
  return insert_values(result).and_then([&] { return insert_closures(result); });
}

Expected<void> Store::insert_values(const StoredResult& result) {
  for (const StoredValue& point : result.values) {
    const auto inserted = database_->execute(
        "INSERT INTO points (result_sha256, source, channel, frequency_text_hz, frequency_hz, "
        "level_m_s2, unit, magnitude, u_magnitude, k_magnitude, expanded_magnitude, phase_rad, "
        "u_phase_rad, k_phase, expanded_phase_rad, flags, excited_axis) "
        "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17)",
        {result.sha256, source_of(point.channel), point.channel, point.frequency_text_hz,
         point.frequency_hz, value(point.level_m_s2), point.unit, value(point.magnitude),
         value(point.of_magnitude.u), value(point.of_magnitude.k),
         value(point.of_magnitude.expanded), value(point.phase_rad), value(point.of_phase.u),
         value(point.of_phase.k), value(point.of_phase.expanded),
         fmt::format("{}", fmt::join(point.flag_names, ",")), point.excited_axis});
    DYNCAL_TRY(inserted);
  }
  for (const StoredPoint& point : result.points) {
    if (point.data_sha256.empty()) {
      continue;
    }
    const auto inserted = database_->execute(
        "INSERT INTO samples (result_sha256, channel, step, repetition, data_sha256, "
        "frequency_hz, level_m_s2, excited_axis, attempt) "
        "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9)",
        {result.sha256, point.channel, std::int64_t{point.step}, std::int64_t{point.repetition},
         point.data_sha256, point.frequency_hz, value(point.level_m_s2), point.excited_axis,
         std::int64_t{point.attempt}});
    DYNCAL_TRY(inserted);
  }
  return {};
}

Expected<void> Store::insert_closures(const StoredResult& result) {
  for (const StoredChannel& channel : result.channels) {
    for (const Closure& closure : channel.closures) {
      const auto inserted = database_->execute(
          "INSERT INTO closures (result_sha256, source, channel, kind, subject, verdict, found, u, "
          "bound, unit, sentence) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)",
          {result.sha256, source_of(channel.channel), channel.channel,
           std::string(to_string(closure.kind)), closure.subject,
           std::string(to_string(closure.verdict)), value(closure.value), value(closure.u),
           value(closure.limit), closure.unit, closure.sentence});
      DYNCAL_TRY(inserted);
    }
  }
  return {};
}

Expected<void> Store::remove(const std::string& result_sha256) {
  for (const char* table : {"closures", "samples", "points", "sources", "results"}) {
    const auto removed = database_->execute(
        fmt::format("DELETE FROM {} WHERE result_sha256 = $1", table), {result_sha256});
    DYNCAL_TRY(removed);
  }
  return {};
}

Expected<std::vector<StoredRun>> Store::runs(const RunFilter& filter,
                                             const SharedWorkCount& count) {
  DYNCAL_TRY(const auto rows, database_->execute(select_runs));
  begin_work(count, "looking through the store", "runs", rows.size());
  std::vector<StoredRun> found;
  for (const DatabaseRow& row : rows) {
    StoredRun run = run_of(row);
    DYNCAL_TRY(run.sources, sources_of(run.result_sha256));
    if (passes(run, filter)) {
      found.push_back(std::move(run));
    }
    add_done(count);
  }
  return found;
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
