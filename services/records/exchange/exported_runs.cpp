#include "services/records/exchange/exported_runs.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <tuple>

#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/base/per_enumerator.hpp"
#include "services/base/version.hpp"
#include "services/contract/topics.hpp"
#include "services/evaluation/result/result_messages.hpp"
#include "services/records/capture/recorded_topics.hpp"
#include "services/views/report/json_members.hpp"

namespace dyncal::inline records {
namespace {

using Json = nlohmann::ordered_json;

template <class Key, class T>
std::vector<T> values_of(std::map<Key, T> all) {
  std::vector<T> values;
  for (auto& [key, value] : all) {
    values.push_back(std::move(value));
  }
  return values;
}

const char* text_of(wire::ExcitationState state) {
  return per_enumerator(state, {"settling", "steady", "done", "aborted"}, "aborted");
}

const char* text_of(wire::MeasurementState state) {
  return per_enumerator(state, {"planned", "running", "done", "aborted"}, "aborted");
}

Json json_of(const ExportedSource& source) {
  Json json{{"name", source.name}, {"bench", source.bench}, {"source", source.source}};
  if (source.description) {
    json["device"] = source.description->device();
    json["serial"] = source.description->serial();
    json["firmware"] = source.description->firmware();
    json["driver"] = source.description->driver();
    json["software"] = source.description->software();
    json["time_base"] = source.description->time_base() == wire::TIME_BASE_UTC ? "utc" : "local";
    json["nominal_rate_hz"] = source.description->nominal_rate_hz();
    json["stamp_uncertainty_s"] = source.description->stamp_uncertainty_s();
  }
  for (const std::size_t session : source.sessions) {
    json["sessions"].push_back(std::to_string(source.recorded->sessions[session]));
  }
  json["samples"] = source.samples;
  json["lost"] = source.lost;
  json["left_out"] = source.left_out;
  for (const auto& channel : source.channels) {
    json["channels"].push_back({{"name", channel.name},
                                {"quantity", channel.quantity},
                                {"unit", channel.unit},
                                {"minimum", channel.minimum},
                                {"maximum", channel.maximum},
                                {"resolution", channel.resolution}});
  }
  return json;
}

Json json_of(const wire::Excitation& excitation) {
  return {{"step", excitation.step()},
          {"repetition", excitation.repetition()},
          {"attempt", excitation.attempt()},
          {"frequency_text_hz", excitation.frequency_text_hz()},
          {"frequency_hz", json_number(frequency_of(excitation))},
          {"level_m_s2", excitation.level_m_s2()},
          {"state", text_of(excitation.state())},
          {"window_begin_utc_ns", excitation.window_begin_utc_ns()},
          {"window_end_utc_ns", excitation.window_end_utc_ns()}};
}

Json json_of(const wire::CalibrationResult& result) {
  return {{"channel", result.channel().to_string()},
          {"step", result.step()},
          {"repetition", result.repetition()},
          {"attempt", std::max(result.attempt(), 1U)},
          {"frequency_hz", result.frequency_hz()},
          {"level_m_s2", result.level_m_s2()},
          {"excited_axis", result.excited_axis()},
          {"valid", result.valid()},
          {"problem", result.problem()},
          {"magnitude", result.magnitude()},
          {"u_magnitude", result.u_magnitude()},
          {"phase_rad", result.phase_rad()},
          {"u_phase_rad", result.u_phase_rad()},
          {"unit", result.unit()},
          {"lost", result.lost()}};
}

// As result files have them, with their channel.
Json closures_of(const std::vector<wire::TransferFunction>& functions, const std::string& run) {
  Json closures = Json::array();
  for (const wire::TransferFunction& function : functions) {
    if (function.run() != run) {
      continue;
    }
    for (const Closure& closure : from_message(function).closures) {
      Json one{{"channel", function.channel().to_string()}};
      one.update(views::JsonWriter::of(closure));
      closures.push_back(std::move(one));
    }
  }
  return closures;
}

} // namespace

Expected<ExportedRuns> read_runs(recording::RecordingReader& reader) {
  namespace topics = bus::topics;
  using Step = std::tuple<std::string, std::uint32_t, std::uint32_t, std::uint32_t>;
  using Value = std::tuple<std::string, std::uint32_t, std::uint32_t, std::string>;
  std::map<Step, wire::Excitation> excitations;
  std::map<Value, wire::CalibrationResult> results;
  std::map<std::pair<std::string, std::string>, wire::TransferFunction> functions;
  ExportedRuns runs;
  const auto take = [&](const recording::MessageInFile& message) {
    if (message.channel.topic == topics::excitation) {
      if (const auto one = recording::decode<wire::Excitation>(message.message.data)) {
        excitations[{one->run().to_string(), one->step(), one->repetition(), one->attempt()}] =
            *one;
      }
    } else if (message.channel.topic == topics::calibration_result) {
      if (const auto one = recording::decode<wire::CalibrationResult>(message.message.data)) {
        results[{one->run().to_string(), one->step(), one->repetition(),
                 one->channel().to_string()}] = *one;
      }
    } else if (message.channel.topic == topics::transfer_function) {
      if (const auto one = recording::decode<wire::TransferFunction>(message.message.data)) {
        functions[{one->run().to_string(), one->channel().to_string()}] = *one;
      }
    }
  };
  const auto report = reader.scan(
      {.message = take,
       .attachment = [&](const recording::Attachment& one) { runs.attachments.push_back(one); },
       .metadata = [&](const recording::Metadata& one) { runs.metadata.push_back(one); }});
  DYNCAL_TRY(report);
  runs.excitations = values_of(std::move(excitations));
  runs.results = values_of(std::move(results));
  runs.functions = values_of(std::move(functions));
  return runs;
}

double frequency_of(const wire::Excitation& excitation) {
  const std::string& text = excitation.frequency_text_hz();
  double frequency = std::numeric_limits<double>::quiet_NaN();
  std::from_chars(text.data(), text.data() + text.size(), frequency);
  return frequency;
}

std::string contents_json(const ExportedRecording& recording, const ExportedRuns& runs) {
  Json json{{"software", software_version()},
            {"recording", recording.reader().path().filename().string()},
            {"written_by", recording.contents().report.library}};
  json["damages"] = Json::array();
  for (const recording::Damage& damage : recording.contents().report.damages) {
    json["damages"].push_back(recording::to_string(damage, recording.reader().path().filename()));
  }
  for (const ExportedSource& source : recording.sources()) {
    json["sources"].push_back(json_of(source));
  }
  json["runs"] = Json::array();
  for (const auto& [name, index] : recording.contents().runs) {
    Json run{{"bench", index.plan.bench().to_string()},
             {"run", name},
             {"state", text_of(index.newest.state())},
             {"message", index.newest.message()},
             {"recipe_sha256", index.plan.recipe_sha256()},
             {"excited_axis", index.plan.excited_axis()},
             {"excitation", Json::array()},
             {"results", Json::array()},
             {"closures", closures_of(runs.functions, name)}};
    for (const wire::Excitation& excitation : runs.excitations) {
      if (excitation.run() == name) {
        run["excitation"].push_back(json_of(excitation));
      }
    }
    for (const wire::CalibrationResult& result : runs.results) {
      if (result.run() == name) {
        run["results"].push_back(json_of(result));
      }
    }
    json["runs"].push_back(std::move(run));
  }
  for (const recording::Metadata& metadata : runs.metadata) {
    json["metadata"][metadata.name] = metadata.entries;
  }
  return json_text(json, 2) + "\n";
}

} // namespace dyncal::inline records
