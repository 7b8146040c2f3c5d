#include "services/records/store/due_calibrations.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include <nlohmann/json.hpp>

#include "services/base/byte_count.hpp"
#include "services/base/calendar_day.hpp"
#include "services/records/store/migrations.hpp"
#include "services/records/store/sensor_library.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline records {
namespace {

constexpr std::size_t day_letters = 10; // of "2026-11-27T..."

// Of the newest document of a sensor: its number, and the day on which the run ended.
Expected<CalibrationDate> date_of_sensor(Database& database, const SensorFile& sensor) {
  CalibrationDate date{.what = "sensor",
                       .name = sensor.manufacturer + " " + sensor.model,
                       .serial = sensor.serial,
                       .owner = sensor.customer ? sensor.customer->name : ""};
  DYNCAL_TRY(const auto rows,
             database.execute("SELECT documents.number, results.ended_utc, documents.issued_utc "
                              "FROM documents LEFT JOIN results ON results.result_sha256 = "
                              "documents.result_sha256 WHERE documents.serial = $1",
                              {sensor.serial}));
  for (const DatabaseRow& row : rows) {
    const std::string& measured = text_of(row[1]).empty() ? text_of(row[2]) : text_of(row[1]);
    const std::string day = measured.substr(0, day_letters);
    if (day >= date.last) {
      date.last = day;
      date.certificate = text_of(row[0]);
    }
  }
  if (!date.last.empty()) {
    date.due = months_after(date.last, *sensor.interval_months);
  }
  return date;
}

Expected<void> add_sensors(const std::string& place, Database& database,
                           std::vector<CalibrationDate>& dates) {
  DYNCAL_TRY(auto library, SensorLibrary::open(place));
  DYNCAL_TRY(const auto sensors, library->all());
  for (const LibrarySensor& one : sensors) {
    if (one.sensor.interval_months) {
      DYNCAL_TRY(auto date, date_of_sensor(database, one.sensor));
      dates.push_back(std::move(date));
    }
  }
  return {};
}

// Of the newest result of each bench.
Expected<void> add_references(Database& database, std::vector<CalibrationDate>& dates) {
  DYNCAL_TRY(const auto rows,
             database.execute("SELECT document, folder FROM results AS one WHERE began_utc = "
                              "(SELECT MAX(began_utc) FROM results AS other "
                              "WHERE other.bench = one.bench)"));
  for (const DatabaseRow& row : rows) {
    ByteCount no_progress;
    const auto result = result_of_text(text_of(row[0]), text_of(row[1]), no_progress);
    if (result && result->corrections && result->corrections->reference_standard) {
      std::ranges::move(
          dates_of_devices(result->corrections->reference_standard->devices, "reference"),
          std::back_inserter(dates));
    }
  }
  return {};
}

} // namespace

std::vector<CalibrationDate> dates_of_devices(const std::vector<CalibratedDevice>& devices,
                                              const std::string& what) {
  std::vector<CalibrationDate> dates;
  for (const CalibratedDevice& device : devices) {
    if (!device.valid_until.empty()) {
      dates.push_back({.what = what,
                       .name = device.name,
                       .serial = device.serial,
                       .last = device.issued,
                       .certificate = device.certificate,
                       .due = device.valid_until});
    }
  }
  return dates;
}

std::vector<CalibrationDate> newest_of_each(std::vector<CalibrationDate> dates) {
  std::map<std::tuple<std::string, std::string, std::string>, CalibrationDate> newest;
  for (CalibrationDate& date : dates) {
    const auto [known, is_new] = newest.try_emplace({date.what, date.name, date.serial}, date);
    if (!is_new && known->second.due < date.due) {
      known->second = std::move(date);
    }
  }
  dates.clear();
  for (auto& [device, date] : newest) {
    dates.push_back(std::move(date));
  }
  std::ranges::stable_sort(dates, {}, &CalibrationDate::due);
  return dates;
}

Expected<std::vector<CalibrationDate>> calibration_dates(const std::string& place) {
  std::vector<CalibrationDate> dates;
  DYNCAL_TRY(auto database, open_migrated(place));
  DYNCAL_TRY(add_sensors(place, *database, dates));
  DYNCAL_TRY(add_references(*database, dates));
  return newest_of_each(std::move(dates));
}

nlohmann::ordered_json calibration_dates_json(const std::vector<CalibrationDate>& dates,
                                              const std::string& today) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  const auto text_or_null = [](const std::string& text) {
    return text.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(text);
  };
  for (const CalibrationDate& date : dates) {
    json.push_back({{"what", date.what},
                    {"name", date.name},
                    {"serial", date.serial},
                    {"owner", text_or_null(date.owner)},
                    {"last", text_or_null(date.last)},
                    {"certificate", text_or_null(date.certificate)},
                    {"due", text_or_null(date.due)},
                    {"overdue", date.is_due_by(today)}});
  }
  return json;
}

} // namespace dyncal::inline records
