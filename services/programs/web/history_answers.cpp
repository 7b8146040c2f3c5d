#include "services/programs/web/history_answers.hpp"

#include <ctime>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "services/base/calendar_day.hpp"
#include "services/base/json_text.hpp"
#include "services/programs/web/request_router.hpp"
#include "services/records/store/due_calibrations.hpp"
#include "services/records/store/history.hpp"
#include "services/records/store/store.hpp"
#include "services/records/store/unwrapped_phases.hpp"
#include "services/views/report/json_members.hpp"
#include "services/views/report/stored_members.hpp"

namespace dyncal::inline programs::web {
namespace {

using Json = nlohmann::ordered_json;

// Of "2026-11-22T10:15:30.123456789Z"; null: not known.
Json milliseconds(const std::string& utc_text) {
  std::tm utc{};
  const char* end = strptime(utc_text.c_str(), "%Y-%m-%dT%H:%M:%S", &utc);
  return end == nullptr ? Json(nullptr) : Json(static_cast<double>(timegm(&utc)) * 1e3);
}

Json open_closures(const Calibration& calibration, const std::string& channel) {
  Json sentences = Json::array();
  for (const OpenClosure& closure : calibration.open_closures) {
    if (closure.channel == channel) {
      sentences.push_back(closure.sentence);
    }
  }
  return sentences;
}

// One row a run and channel.
Json runs_json(const std::vector<Calibration>& calibrations) {
  Json runs = Json::array();
  for (const Calibration& calibration : calibrations) {
    std::map<std::string, Json> channels;
    for (const StoredValue& point : calibration.points) {
      Json& points = channels.try_emplace(point.channel, Json::array()).first->second;
      points.push_back(JsonWriter::of(point));
    }
    for (auto& [channel, points] : channels) {
      runs.push_back({{"run", calibration.run.run},
                      {"bench", calibration.run.bench},
                      {"utc_ms", milliseconds(calibration.run.began_utc)},
                      {"state", calibration.run.state},
                      {"channel", channel},
                      {"open_closures", open_closures(calibration, channel)},
                      {"points", std::move(points)}});
    }
  }
  return runs;
}

// Each value against the one before it.
Json en_json(const History& history) {
  Json rows = Json::array();
  for (const HistoryLine& line : history.lines) {
    for (std::size_t i = 1; i < line.values.size(); ++i) {
      const HistoryValue& value = line.values[i];
      if (!value.en_magnitude && !value.en_phase) {
        continue;
      }
      const auto run_of = [&](const HistoryValue& one) {
        return history.calibrations[one.calibration].run.run;
      };
      const auto number = [](const std::optional<double>& en) {
        return en ? json_number(*en) : Json(nullptr);
      };
      rows.push_back({{"of", run_of(value)},
                      {"against", run_of(line.values[i - 1])},
                      {"channel", line.point.channel},
                      {"frequency_text_hz", line.frequency_text_hz},
                      {"level_m_s2", line.point.level_m_s2},
                      {"excited_axis", line.point.axis},
                      {"en_magnitude", number(value.en_magnitude)},
                      {"en_phase", number(value.en_phase)}});
    }
  }
  return rows;
}

Expected<void> add_history(Store& store, const std::string& sensor, Json& json) {
  DYNCAL_TRY(json["sensors"], store.sensors());
  if (sensor.empty()) {
    return {};
  }
  DYNCAL_TRY(auto calibrations, store.calibrations(sensor));
  if (calibrations.size() > HistoryAnswers::max_runs) {
    calibrations.erase(calibrations.begin(),
                       calibrations.end() - static_cast<std::ptrdiff_t>(HistoryAnswers::max_runs));
  }
  DYNCAL_TRY(store.add_common_parts(calibrations));
  unwrap_phases(calibrations);
  json["runs"] = runs_json(calibrations);
  json["en"] = en_json(history_of(sensor, std::move(calibrations)));
  return {};
}

Expected<void> add_due(const std::string& place, Json& json) {
  DYNCAL_TRY(const auto dates, calibration_dates(place));
  json["due"] = calibration_dates_json(dates, today_utc());
  return {};
}

} // namespace

bool HistoryAnswers::answer(const httplib::Request& request, httplib::Response& response) {
  if (request.path != "/api/history") {
    return false;
  }
  const std::string sensor = request.get_param_value("sensor");
  Json json{{"sensor", sensor},
            {"sensors", Json::array()},
            {"runs", Json::array()},
            {"en", Json::array()},
            {"due", Json::array()}};
  const std::unique_lock lock(mutex_, longest_wait);
  if (!lock) {
    json["problem"] = "the store is slow and is still answering others; ask again";
    response.set_content(json_text(json), "application/json");
    return true;
  }
  auto store = Store::open_existing(place_);
  if (place_.empty() || !store) {
    json["problem"] = place_.empty() ? "there is no store (--store)" : store.error().message;
    response.set_content(json_text(json), "application/json");
    return true;
  }
  const auto added =
      add_history(**store, sensor, json).and_then([&] { return add_due(place_, json); });
  if (!added) {
    answer_error(500, "failed", added.error().message, response);
    return true;
  }
  response.set_content(json_text(json), "application/json");
  return true;
}

} // namespace dyncal::inline programs::web
