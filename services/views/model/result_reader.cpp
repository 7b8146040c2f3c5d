#include "services/views/model/result_reader.hpp"

#include <cmath>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/counted_file.hpp"
#include "services/views/report/checked_json.hpp"

namespace dyncal::services {
namespace {

using Json = nlohmann::json;
using Node = CheckedJson;

analysis::Distribution parse_distribution(const std::string& name) {
  using analysis::Distribution;
  for (const Distribution one : {Distribution::normal, Distribution::rectangular,
                                 Distribution::triangular, Distribution::arcsine}) {
    if (to_string(one) == name) {
      return one;
    }
  }
  return Distribution::normal;
}

analysis::Repeats parse_repeats(const Node& row) {
  using analysis::Repeats;
  const std::string name = row.text("repeats");
  for (const Repeats one : {Repeats::anew, Repeats::common, Repeats::common_delay}) {
    if (to_string(one) == name) {
      return one;
    }
  }
  throw BadKey{
      fmt::format("the budget has repeats = '{}', which this version does not know", name)};
}

analysis::Contribution contribution_of(const Node& row) {
  const analysis::NamedKind named = analysis::parse_contribution_name(row.text("name"));
  analysis::Contribution result;
  result.kind = named.kind;
  result.subject = named.subject;
  result.distribution = parse_distribution(row.text("distribution"));
  result.repeats = parse_repeats(row);
  const double freedom = row.number("degrees_of_freedom");
  result.degrees_of_freedom =
      std::isfinite(freedom) ? freedom : analysis::infinite_degrees_of_freedom;
  result.u_magnitude_rel = row.number("u_magnitude_rel");
  result.u_phase_rad = row.number("u_phase_rad");
  result.u_lasting_magnitude_rel = row.number("u_lasting_magnitude_rel");
  return result;
}

SinglePoint point_of(const Node& point) {
  SinglePoint result{point.text("channel"),      point.number("frequency_hz"),
                     point.number("level_m_s2"), point.number("magnitude"),
                     point.number("phase_rad"),  {}};
  for (const Node& row : point.nodes("budget")) {
    result.budget.push_back(contribution_of(row));
  }
  return result;
}

TransferValue value_of(const Node& value) {
  return {.channel = value.text("channel"),
          .frequency_text_hz = value.text("frequency_text_hz"),
          .frequency_hz = value.number("frequency_hz"),
          .level_m_s2 = value.number("level_m_s2"),
          .magnitude = value.number("magnitude"),
          .expanded_magnitude = value.number("U_magnitude"),
          .phase_rad = value.number("phase_rad"),
          .expanded_phase_rad = value.number("U_phase_rad"),
          .u_independent_phase_rad = value.number("u_independent_phase_rad"),
          .unit = value.text("unit"),
          .flag_names = value.texts("flag_names")};
}

void check_schema(const Node& root) {
  if (!root.has("schema")) {
    throw BadKey{"there is no key 'schema', so it is not a result that dyncal 0.2 or later wrote "
                 "with --json; evaluate the run again"};
  }
  const Node schema = root.node("schema");
  const std::string name = schema.text("name");
  if (name != "dyncal-result") {
    throw BadKey{
        fmt::format("the schema is '{}', but a model is fitted to a 'dyncal-result', which "
                    "dyncal run and dyncal analyse write with --json",
                    name)};
  }
}

ResultContents contents_of(const Node& root) {
  check_schema(root);
  ResultContents contents;
  for (const Node& channel : root.nodes("channels")) {
    if (channel.boolean("responds")) {
      contents.channels_that_respond.push_back(channel.text("channel"));
    }
  }
  for (const Node& value : root.nodes("transfer_function")) {
    contents.values.push_back(value_of(value));
  }
  for (const Node& point : root.nodes("points")) {
    if (point.boolean("valid")) {
      contents.points.push_back(point_of(point));
    }
  }
  for (const Node& clock : root.nodes("sample_clock")) {
    contents.source_rates_hz.emplace_back(clock.text("source"), clock.number("mean_rate_hz"));
  }
  return contents;
}

} // namespace

Expected<ResultContents> read_result(const std::filesystem::path& path, ByteCount& bytes) {
  CountedFile file(path, bytes);
  if (!file.stream()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: cannot read this result file; does it exist, and may you read it?",
                            path.string()));
  }
  const Json json = Json::parse(file.stream(), nullptr, false);
  if (json.is_discarded()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: not JSON; give a file that dyncal run or dyncal analyse wrote "
                            "with --json",
                            path.string()));
  }
  try {
    ResultContents contents = contents_of(Node(json, ""));
    contents.file = path.string();
    return contents;
  } catch (const BadKey& bad) {
    return fail(ErrorCode::bad_file, fmt::format("{}: {}", path.string(), bad.sentence));
  }
}

} // namespace dyncal::services
