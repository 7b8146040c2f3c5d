#include "services/records/store/sensor_library.hpp"

#include <ctime>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "services/records/store/audit_trail.hpp"
#include "services/records/store/migrations.hpp"

namespace dyncal::inline records {
namespace {

const char* const columns = "serial, version, added_utc, file";

// The first thing in the file that belongs to one calibration; empty: nothing does.
std::string passing_part(const SensorFile& sensor) {
  if (!sensor.certificate_number.empty()) {
    return "[certificate]";
  }
  if (!sensor.received.empty()) {
    return "'received'";
  }
  if (!sensor.condition.empty()) {
    return "'condition'";
  }
  return sensor.conditions.empty() ? "" : "[conditions]";
}

} // namespace

Expected<std::unique_ptr<SensorLibrary>> SensorLibrary::open(const std::string& place) {
  if (place.empty()) {
    return fail(ErrorCode::bad_argument,
                "sensors are kept in the store of all results; name one with --store");
  }
  DYNCAL_TRY(auto database, open_migrated(place));
  return std::unique_ptr<SensorLibrary>(
      new SensorLibrary(std::move(database), without_password(place)));
}

Expected<SensorAddition> SensorLibrary::add_one(const SensorText& added, bool may_change,
                                                const ActingPerson& by) {
  const auto& [text, path] = added;
  DYNCAL_TRY(const auto sensor, parse_sensor_file(text, path));
  if (const std::string part = passing_part(sensor); !part.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: {} belongs to one calibration, not to the sensor; take it out, "
                            "and state it when the document is made",
                            path.string(), part));
  }
  DYNCAL_TRY(const auto known, find(sensor.serial));
  if (known && known->text == text) {
    return SensorAddition::already_there;
  }
  if (known && !may_change) {
    return fail(ErrorCode::bad_argument,
                fmt::format("{}: sensor '{}' is in the library with another file since {}; see "
                            "'dyncal sensor show {} --file', and --change it",
                            path.string(), sensor.serial, known->added_utc.substr(0, 10),
                            sensor.serial));
  }
  const std::string now = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  const std::int64_t version = known ? known->version + 1 : 1;
  DYNCAL_TRY(database_->execute(
      "INSERT INTO sensors (serial, version, added_utc, file) VALUES ($1, $2, $3, $4)",
      {sensor.serial, version, now, text}));
  DYNCAL_TRY(add_to_audit(*database_,
                          {AuditAction::sensor_changed, sensor_hash(sensor.serial, version, text),
                           fmt::format("file of sensor {}, version {}", sensor.serial, version)},
                          by));
  return known ? SensorAddition::changed : SensorAddition::added;
}

Expected<std::vector<SensorAddition>> SensorLibrary::add(const std::vector<SensorText>& sensors,
                                                         bool may_change, const ActingPerson& by) {
  std::vector<SensorAddition> additions;
  const auto kept = database_->transaction([&]() -> Expected<void> {
    for (const SensorText& sensor : sensors) {
      DYNCAL_TRY(const auto addition, add_one(sensor, may_change, by));
      additions.push_back(addition);
    }
    return {};
  });
  DYNCAL_TRY(kept);
  return additions;
}

Expected<LibrarySensor> SensorLibrary::sensor_of(const DatabaseRow& row) const {
  std::string text = text_of(row[3]);
  DYNCAL_TRY(auto sensor,
             parse_sensor_file(text, fmt::format("sensor '{}' of {}", text_of(row[0]), place_)));
  return LibrarySensor{.sensor = std::move(sensor),
                       .version = static_cast<int>(integer_of(row[1])),
                       .added_utc = text_of(row[2]),
                       .text = std::move(text)};
}

Expected<std::vector<LibrarySensor>>
SensorLibrary::sensors_of(const std::vector<DatabaseRow>& rows) const {
  std::vector<LibrarySensor> sensors;
  for (const DatabaseRow& row : rows) {
    DYNCAL_TRY(auto sensor, sensor_of(row));
    sensors.push_back(std::move(sensor));
  }
  return sensors;
}

Expected<std::vector<LibrarySensor>> SensorLibrary::versions(const std::string& serial) {
  DYNCAL_TRY(const auto rows,
             database_->execute(
                 fmt::format("SELECT {} FROM sensors WHERE serial = $1 ORDER BY version", columns),
                 {serial}));
  return sensors_of(rows);
}

Expected<std::optional<LibrarySensor>> SensorLibrary::find(const std::string& serial) {
  DYNCAL_TRY(auto known, versions(serial));
  return known.empty() ? std::nullopt : std::optional(std::move(known.back()));
}

Expected<std::vector<LibrarySensor>> SensorLibrary::all() {
  DYNCAL_TRY(const auto rows,
             database_->execute(fmt::format(
                 "SELECT {} FROM sensors AS one WHERE version = (SELECT MAX(version) FROM sensors "
                 "AS other WHERE other.serial = one.serial) ORDER BY serial",
                 columns)));
  return sensors_of(rows);
}

} // namespace dyncal::inline records
