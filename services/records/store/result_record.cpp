#include "services/records/store/result_record.hpp"

#include <array>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/bench/file/named_files.hpp"
#include "services/contract/channel_name.hpp"
#include "services/contract/digest.hpp"

namespace dyncal::services {
namespace {

using Json = nlohmann::ordered_json;

// Which may differ between two evaluations of the same samples by the same recipe.
constexpr std::array volatile_members{"began_utc", "ended_utc", "software", "analysis", "dds"};

// Of an evaluation of files, without a network (result.schema.json).
constexpr const char* no_network = "none";

std::string text(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

double number(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? found->get<double>()
                                                   : std::numeric_limits<double>::quiet_NaN();
}

std::string content_sha256(Json json) {
  for (const char* member : volatile_members) {
    json.erase(member);
  }
  return sha256_hex(json_text(json));
}

std::string source_of(const std::string& channel) {
  return channel.substr(0, channel.find('/'));
}

std::string joined(const Json& names) {
  std::string all;
  for (const Json& name : names) {
    all += (all.empty() ? "" : ",") + name.get<std::string>();
  }
  return all;
}

RecordedPoint point_of(const Json& json) {
  RecordedPoint point;
  point.channel = json.at("channel");
  point.source = source_of(point.channel);
  point.frequency_text_hz = text(json, "frequency_text_hz");
  point.frequency_hz = json.at("frequency_hz");
  point.level_m_s2 = number(json, "level_m_s2");
  point.unit = text(json, "unit");
  point.magnitude = number(json, "magnitude");
  point.u_magnitude = number(json, "u_magnitude");
  point.k_magnitude = number(json, "k_magnitude");
  point.expanded_magnitude = number(json, "U_magnitude");
  point.phase_rad = number(json, "phase_rad");
  point.u_phase_rad = number(json, "u_phase_rad");
  point.k_phase = number(json, "k_phase");
  point.expanded_phase_rad = number(json, "U_phase_rad");
  point.flags = json.contains("flag_names") ? joined(json["flag_names"]) : std::string();
  return point;
}

void add_values(const Json& json, ResultRecord& record) {
  for (const Json& point : json.at("transfer_function")) {
    record.points.push_back(point_of(point));
  }
  std::set<std::int64_t> measured;
  for (const Json& point : json.at("points")) {
    if (point.at("valid").get<bool>()) {
      measured.insert(point.at("step").get<std::int64_t>());
    }
    if (const std::string sha256 = text(point, "data_sha256"); !sha256.empty()) {
      record.samples.push_back({point.at("channel"), point.at("step").get<std::int64_t>(),
                                point.at("repetition").get<std::int64_t>(), sha256});
    }
  }
  record.measured_steps = static_cast<std::int64_t>(measured.size());
  for (const Json& source : json.at("sources")) {
    record.sources.push_back({source.at("source"), text(source, "device"), text(source, "serial"),
                              text(source, "firmware"), text(source, "software")});
  }
}

RunCompletion state_of(const Json& json, const ResultRecord& record) {
  const bool is_live = text(json.at("dds"), "analysis") != no_network;
  if (is_live && record.ended_utc.empty()) {
    return RunCompletion::unfinished;
  }
  if (json.at("interrupted").get<bool>()) {
    return RunCompletion::interrupted;
  }
  if (!record.problem.empty()) {
    return RunCompletion::ended_early;
  }
  return record.measured_steps < record.planned_steps ? RunCompletion::incomplete
                                                      : RunCompletion::complete;
}

ResultRecord record_of(const Json& json) {
  if (json.at("schema").at("name") != "dyncal-result") {
    json.at("name"); // throws: of another kind
  }
  ResultRecord record;
  record.content_sha256 = content_sha256(json);
  record.recipe_sha256 = json.at("recipe_sha256");
  record.bench = json.at("bench");
  record.run = json.at("run");
  record.method = json.at("method");
  record.began_utc = text(json, "began_utc");
  record.ended_utc = text(json, "ended_utc");
  record.software = json.at("software");
  record.planned_steps = json.at("planned_steps");
  record.problem = text(json, "problem");
  record.recipe = text(json, "recipe");
  add_values(json, record);
  record.state = state_of(json, record);
  return record;
}

} // namespace

std::string to_string(RunCompletion state) {
  switch (state) {
  case RunCompletion::complete:
    return "complete";
  case RunCompletion::incomplete:
    return "incomplete";
  case RunCompletion::interrupted:
    return "interrupted";
  case RunCompletion::ended_early:
    return "ended-early";
  case RunCompletion::unfinished:
    return "unfinished";
  }
  return "";
}

Expected<ResultRecord> read_result_record(const std::filesystem::path& path) {
  const std::filesystem::path file =
      std::filesystem::is_directory(path) ? path / result_file_name : path;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    return fail(
        ErrorCode::bad_file,
        fmt::format("{} cannot be read; name a result file or a run folder", file.string()));
  }
  const std::string document{std::istreambuf_iterator<char>(stream), {}};
  const Json json = Json::parse(document, nullptr, false);
  try {
    ResultRecord record = record_of(json);
    record.result_sha256 = sha256_hex(document);
    record.document = document;
    record.folder = std::filesystem::absolute(path).lexically_normal().string();
    return record;
  } catch (const nlohmann::json::exception& problem) {
    return fail(ErrorCode::bad_file, fmt::format("{} is not a result of a run of dyncal: {}",
                                                 file.string(), problem.what()));
  }
}

} // namespace dyncal::services
