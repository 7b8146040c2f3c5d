#include "services/views/report/stored_result.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/counted_text.hpp"
#include "services/base/json_text.hpp"
#include "services/base/whole_file.hpp"
#include "services/bench/file/named_files.hpp"
#include "services/contract/digest.hpp"
#include "services/views/report/json_members.hpp"
#include "services/views/report/json_schema.hpp"
#include "services/views/report/result_schema.hpp"
#include "services/views/report/stored_members.hpp"

namespace dyncal::inline views {
namespace {

using Json = nlohmann::json;

constexpr std::uintmax_t max_result_bytes = 1U << 30U;

// Which may differ between two evaluations of the same samples by the same recipe.
constexpr std::array volatile_members{"began_utc",  "ended_utc", "software",     "analysis",
                                      "dds",        "check",     "conducted_by", "comment",
                                      "conditions", "sensor"};

tl::unexpected<Error> refuse(const std::filesystem::path& file, const std::string& why) {
  return fail(ErrorCode::bad_file, fmt::format("{}: {}", file.string(), why));
}

// Before all else, so that a file of another kind is not called a damaged result.
std::optional<std::string> other_schema(const Json& json) {
  const auto schema = json.is_object() ? json.find("schema") : json.end();
  if (!json.is_object() || schema == json.end() || !schema->is_object()) {
    return "there is no 'schema' in it, so it is not a result that dyncal 0.2 or later wrote; "
           "evaluate the run again";
  }
  const Json name = schema->value("name", Json());
  const Json version = schema->value("version", Json());
  if (name != "dyncal-result") {
    return fmt::format("its schema is {}, not \"dyncal-result\", which dyncal run and dyncal "
                       "analyse write",
                       json_text(name).substr(0, 60));
  }
  if (version != result_schema_version && version != 1) {
    return fmt::format("it has version {} of the schema, and this dyncal reads versions 1 to {}; "
                       "use the dyncal that wrote it, or a newer one",
                       json_text(version).substr(0, 60), result_schema_version);
  }
  return std::nullopt;
}

void rename(Json& object, const char* from, const char* to) {
  if (object.is_object() && object.contains(from)) {
    object[to] = std::move(object[from]);
    object.erase(from);
  }
}

// "noise of" of version 1 is "fit_noise"; what is not known is left, for the schema to refuse.
void name_kind(Json& row) {
  if (!row.is_object() || !row.contains("kind")) {
    return;
  }
  for (int i = 0; i <= static_cast<int>(analysis::ContributionKind::other); ++i) {
    const auto kind = static_cast<analysis::ContributionKind>(i);
    if (row["kind"] == std::string(to_string(kind))) {
      row["kind"] = std::string(identifier_of(kind));
      return;
    }
  }
}

// What is no list is left, for the schema to refuse.
template <class Change>
void for_each_in(Json& json, const char* name, Change change) {
  if (json.is_object() && json.contains(name) && json[name].is_array()) {
    std::for_each(json[name].begin(), json[name].end(), change);
  }
}

// Names that meant two things have one meaning since version 2.
void upgrade(Json& json) {
  if (json["schema"]["version"] != 1) {
    return;
  }
  json["schema"]["version"] = result_schema_version;
  rename(json, "flags", "flag_legend");
  for_each_in(json, "sample_clock", [](Json& clock) {
    rename(clock, "events", "event_count");
    rename(clock, "event_list", "events");
  });
  for_each_in(json, "points", [](Json& point) { for_each_in(point, "budget", name_kind); });
}

// The schema cannot say this.
std::optional<std::string> contradiction(const StoredResult& result) {
  const auto valid = std::count_if(result.points.begin(), result.points.end(),
                                   [](const StoredPoint& point) { return point.valid; });
  if (valid > 0 && result.values.empty()) {
    return fmt::format(
        "transfer_function is empty, but {} single results have a value: its run lost "
        "its analysis before the means were taken, or the file was changed; evaluate "
        "the recording of the run once more with 'dyncal analyse'",
        valid);
  }
  return std::nullopt;
}

std::string content_sha256(Json json) {
  for (const char* member : volatile_members) {
    json.erase(member);
  }
  return sha256_hex(json_text(json));
}

Expected<StoredResult> with_values(Expected<StoredResult> result) {
  if (result && result->values.empty()) {
    return refuse(result->file, "the run has no value (transfer_function is empty)");
  }
  return result;
}

template <class Item>
std::vector<Item> those_of(const std::vector<Item>& all, const std::string& channel) {
  std::vector<Item> chosen;
  std::copy_if(all.begin(), all.end(), std::back_inserter(chosen),
               [&](const Item& one) { return one.channel == channel; });
  return chosen;
}

} // namespace

std::vector<StoredValue> StoredResult::values_of(const std::string& channel) const {
  return those_of(values, channel);
}

std::vector<StoredPoint> StoredResult::points_of(const std::string& channel) const {
  return those_of(points, channel);
}

std::vector<Closure> StoredResult::closures_of(const std::string& channel) const {
  const auto found = std::ranges::find(channels, channel, &StoredChannel::channel);
  return found == channels.end() ? std::vector<Closure>{} : found->closures;
}

std::vector<std::string> StoredResult::open_closures(const std::vector<std::string>& names) const {
  std::vector<std::string> open;
  for (const std::string& channel : names) {
    for (const Closure& closure : closures_of(channel)) {
      if (is_open(closure)) {
        open.push_back(closure_line(channel, closure));
      }
    }
  }
  return open;
}

std::vector<StoredPoint> StoredResult::points_of(const std::vector<std::string>& names) const {
  std::vector<StoredPoint> chosen;
  for (const std::string& channel : names) {
    for (StoredPoint& point : points_of(channel)) {
      chosen.push_back(std::move(point));
    }
  }
  return chosen;
}

const analysis::GroupDelay* StoredResult::group_delay_of(const std::string& channel) const {
  const auto found = std::ranges::find(group_delays, channel, &StoredDelay::channel);
  return found == group_delays.end() ? nullptr : &found->delay;
}

std::filesystem::path result_file_of(const std::filesystem::path& run) {
  std::error_code unknown;
  return std::filesystem::is_directory(run, unknown) ? run / result_file_name : run;
}

Expected<StoredResult> result_of_text(const std::string& text, const std::filesystem::path& file,
                                      ByteCount& count) {
  static const Json schema = Json::parse(result_schema_text());
  const std::uint64_t done = count.done();
  const CountedText counted(text, count);
  Json json = Json::parse(counted.begin(), counted.end(), nullptr, false);
  count.set_done(done + text.size());
  if (json.is_discarded()) {
    return refuse(file, "not JSON, or not all of it; give a file that dyncal run or dyncal analyse "
                        "wrote");
  }
  if (const auto other = other_schema(json)) {
    return refuse(file, *other);
  }
  upgrade(json);
  if (const auto deviation = deviation_from(schema, json)) {
    return refuse(file, *deviation);
  }
  StoredResult result;
  JsonReader reader(json);
  members(reader, result);
  if (const auto wrong = contradiction(result)) {
    return refuse(file, *wrong);
  }
  result.file = file;
  result.sha256 = sha256_hex(text);
  result.content_sha256 = content_sha256(json);
  return result;
}

Expected<std::string> read_result_text(const std::filesystem::path& run) {
  auto text = read_whole_file(result_file_of(run), max_result_bytes);
  if (!text) {
    return fail(ErrorCode::bad_file, text.error().message +
                                         "; give a run folder, or a result file that dyncal run or "
                                         "dyncal analyse wrote");
  }
  return text;
}

Expected<StoredResult> read_result(const std::filesystem::path& run, ByteCount& count) {
  const auto text = read_result_text(run);
  return text ? result_of_text(*text, result_file_of(run), count) : fail(text.error());
}

Expected<StoredResult> read_result(const std::filesystem::path& run) {
  ByteCount no_progress;
  return read_result(run, no_progress);
}

Expected<StoredResult> read_values(const std::filesystem::path& run, ByteCount& count) {
  return with_values(read_result(run, count));
}

Expected<StoredResult> read_values(const std::filesystem::path& run) {
  return with_values(read_result(run));
}

} // namespace dyncal::inline views
