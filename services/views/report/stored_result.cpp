#include "services/views/report/stored_result.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "services/contract/digest.hpp"

namespace dyncal::services {
namespace {

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();
constexpr std::uintmax_t max_result_bytes = 1U << 30U;
constexpr double max_count = 9007199254740992.0; // 2^53

double count_of(const CheckedJson& node, const char* key) {
  const double count = node.number(key);
  if (!(count >= 0.0 && count <= max_count)) {
    throw BadKey{fmt::format("{} is not a count", key)};
  }
  return count;
}

unsigned number_of(const CheckedJson& node, const char* key) {
  return static_cast<unsigned>(
      std::min(count_of(node, key), double{std::numeric_limits<unsigned>::max()}));
}

std::uint64_t samples_of(const CheckedJson& node, const char* key) {
  return static_cast<std::uint64_t>(count_of(node, key));
}

StoredValue value_of(const CheckedJson& node) {
  return {
      .channel = node.text("channel"),
      .frequency_text_hz = node.text("frequency_text_hz"),
      .frequency_hz = node.number("frequency_hz"),
      .level_m_s2 = node.number("level_m_s2"),
      .magnitude = node.number("magnitude"),
      .of_magnitude = {node.number("u_magnitude"), node.number("k_magnitude"),
                       node.number("U_magnitude")},
      .phase_rad = node.number("phase_rad"),
      .unwrapped_phase_rad = node.number("unwrapped_phase_rad"),
      .of_phase = {node.number("u_phase_rad"), node.number("k_phase"), node.number("U_phase_rad")},
      .coverage_probability = node.number("coverage_probability"),
      .unit = node.text("unit"),
      .repetitions = number_of(node, "repetitions"),
      .flags = node.texts("flags"),
      .flag_names = node.texts("flag_names")};
}

StoredContribution contribution_of(const CheckedJson& node) {
  return {.name = node.text("name"),
          .distribution = node.text("distribution"),
          .repeats = node.text("repeats"),
          .degrees_of_freedom = node.number("degrees_of_freedom"),
          .u_magnitude_rel = node.number("u_magnitude_rel"),
          .u_phase_rad = node.number("u_phase_rad")};
}

// Of the channel itself; results of older versions have none.
double residual_of(const CheckedJson& point) {
  if (point.has("signals")) {
    for (const CheckedJson& signal : point.nodes("signals")) {
      if (signal.text("channel") == point.text("channel")) {
        return signal.number("residual_rel");
      }
    }
  }
  return not_known;
}

StoredPoint point_of(const CheckedJson& node) {
  StoredPoint point{.channel = node.text("channel"),
                    .frequency_text_hz = node.text("frequency_text_hz"),
                    .frequency_hz = node.number("frequency_hz"),
                    .level_m_s2 = node.number("level_m_s2"),
                    .step = number_of(node, "step"),
                    .repetition = number_of(node, "repetition"),
                    .valid = node.boolean("valid"),
                    .problem = node.text_or("problem", ""),
                    .magnitude = node.number("magnitude"),
                    .u_magnitude = node.number("u_magnitude"),
                    .phase_rad = node.number("phase_rad"),
                    .u_phase_rad = node.number("u_phase_rad"),
                    .measured_frequency_hz = node.number_or("measured_frequency_hz", not_known),
                    .measured_level_m_s2 = node.number_or("measured_level_m_s2", not_known),
                    .temperature_degc = node.number_or("temperature_degc", not_known),
                    .residual_rel = residual_of(node),
                    .has_monte_carlo = node.has("monte_carlo"),
                    .lost = samples_of(node, "lost"),
                    .data_sha256 = node.text("data_sha256"),
                    .budget = {},
                    .flag_names = node.texts("flag_names")};
  for (const CheckedJson& row : node.nodes("budget")) {
    point.budget.push_back(contribution_of(row));
  }
  return point;
}

void check_schema(const CheckedJson& root) {
  if (!root.has("schema")) {
    throw BadKey{"there is no key 'schema', so it is not a result that dyncal 0.2 or later wrote; "
                 "evaluate the run again"};
  }
  const std::string name = root.node("schema").text("name");
  if (name != "dyncal-result") {
    throw BadKey{fmt::format("the schema is '{}', but documents are made of a 'dyncal-result', "
                             "which dyncal run and dyncal analyse write",
                             name)};
  }
}

void read_head(const CheckedJson& root, StoredResult& result) {
  result.bench = root.text("bench");
  result.run = root.text("run");
  result.method = root.text("method");
  result.began_utc = root.text_or("began_utc", "");
  result.ended_utc = root.text_or("ended_utc", "");
  result.software = root.text("software");
  result.problem = root.text("problem");
  result.interrupted = root.boolean("interrupted");
  result.planned_steps = number_of(root, "planned_steps");
  result.recipe_sha256 = root.text("recipe_sha256");
}

void read_contents(StoredResult& result) {
  const CheckedJson root = result.root();
  check_schema(root);
  read_head(root, result);
  for (const CheckedJson& flag : root.nodes("flags")) {
    result.flags.push_back({flag.text("name"), flag.texts("sentences"), flag.text("meaning")});
  }
  for (const CheckedJson& channel : root.nodes("channels")) {
    result.channels.push_back({.channel = channel.text("channel"),
                               .unit = channel.text("unit"),
                               .responds = channel.boolean("responds"),
                               .lost = samples_of(channel, "lost"),
                               .flag_names = channel.texts("flag_names")});
  }
  for (const CheckedJson& value : root.nodes("transfer_function")) {
    result.values.push_back(value_of(value));
  }
  for (const CheckedJson& point : root.nodes("points")) {
    result.points.push_back(point_of(point));
  }
  if (result.values.empty()) {
    throw BadKey{"the run has no value (transfer_function is empty), so there is nothing to make a "
                 "document of"};
  }
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

std::filesystem::path result_file_of(const std::filesystem::path& run) {
  std::error_code unknown;
  return std::filesystem::is_directory(run, unknown) ? run / "result.json" : run;
}

Expected<std::string> read_whole_file(const std::filesystem::path& path, std::uintmax_t max_bytes) {
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: is a folder; name a file in it", path.string()));
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: cannot be read ({})", path.string(), std::strerror(errno)));
  }
  std::string text;
  std::string part(1U << 16U, '\0');
  while (stream.read(part.data(), static_cast<std::streamsize>(part.size())) ||
         stream.gcount() > 0) {
    text.append(part, 0, static_cast<std::size_t>(stream.gcount()));
    if (text.size() > max_bytes) {
      return fail(ErrorCode::bad_file, fmt::format("{}: is larger than {} bytes, which no such "
                                                   "file needs; is it the right one?",
                                                   path.string(), max_bytes));
    }
  }
  if (stream.bad()) {
    return fail(ErrorCode::bad_file, fmt::format("{}: cannot be read whole", path.string()));
  }
  return text;
}

Expected<StoredResult> read_stored_result(const std::filesystem::path& run) {
  StoredResult result;
  result.file = result_file_of(run);
  const auto text = read_whole_file(result.file, max_result_bytes);
  if (!text) {
    return fail(ErrorCode::bad_file, text.error().message +
                                         "; give a run folder, or a result file that dyncal run or "
                                         "dyncal analyse wrote");
  }
  result.sha256 = sha256_hex(*text);
  result.json =
      std::make_shared<const nlohmann::json>(nlohmann::json::parse(*text, nullptr, false));
  if (result.json->is_discarded()) {
    return fail(ErrorCode::bad_file, fmt::format("{}: not JSON, or not all of it; give a file that "
                                                 "dyncal run or dyncal analyse wrote",
                                                 result.file.string()));
  }
  try {
    read_contents(result);
  } catch (const BadKey& bad) {
    return fail(ErrorCode::bad_file, fmt::format("{}: {}", result.file.string(), bad.sentence));
  }
  return result;
}

} // namespace dyncal::services
