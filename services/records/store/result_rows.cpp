#include "services/records/store/result_rows.hpp"

#include <array>
#include <ctime>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dyncal::inline records {
namespace {

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

std::string source_of(const std::string& channel) {
  return channel.substr(0, channel.find('/'));
}

Expected<void> insert_values(Database& database, const StoredResult& result) {
  for (const StoredValue& point : result.values) {
    const auto inserted = database.execute(
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
    const auto inserted = database.execute(
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

Expected<void> insert_closures(Database& database, const StoredResult& result) {
  for (const StoredChannel& channel : result.channels) {
    for (const Closure& closure : channel.closures) {
      const auto inserted = database.execute(
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

} // namespace

Expected<void> insert_result(Database& database, const ResultRecord& record) {
  const StoredResult& result = record.result;
  const auto done = database.execute(
      "INSERT INTO results (result_sha256, content_sha256, recipe_sha256, bench, run, state, "
      "method, began_utc, ended_utc, software, planned_steps, measured_steps, problem, recipe, "
      "folder, added_utc, document, operator) "
      "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17, $18)",
      {result.sha256, result.content_sha256, result.recipe_sha256, result.bench, result.run,
       to_string(record.state), result.method, result.began_utc, result.ended_utc, result.software,
       std::int64_t{result.planned_steps}, record.measured_steps, result.problem, result.recipe,
       record.folder, now_utc(), record.document,
       result.conducted_by ? text_of(*result.conducted_by) : std::string()});
  DYNCAL_TRY(done);
  for (const RunSource& source : result.sources) {
    const auto inserted = database.execute(
        "INSERT INTO sources (result_sha256, source, device, serial, firmware, software) "
        "VALUES ($1, $2, $3, $4, $5, $6)",
        {result.sha256, source.source, source.description.device, source.description.serial,
         source.description.firmware, source.software});
    DYNCAL_TRY(inserted);
  }
  return insert_values(database, result).and_then([&] {
    return insert_closures(database, result);
  });
}

Expected<void> remove_result(Database& database, const std::string& result_sha256) {
  for (const char* table : {"closures", "samples", "points", "sources", "results"}) {
    const auto removed = database.execute(
        fmt::format("DELETE FROM {} WHERE result_sha256 = $1", table), {result_sha256});
    DYNCAL_TRY(removed);
  }
  return {};
}

} // namespace dyncal::inline records
