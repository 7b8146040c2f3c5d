// What the readers of dyncal's TOML files say to a text, for the tests of the guide: one JSON
// object a line in, {"reader": "bench"|"laboratory"|"sensor"|"reference"|"tolerance", "text": ...,
// "path": ...}, one a line out, {"problem": ..., "asked": [...]}; "problem" is empty for a text
// that is accepted. "path" is in the folder of the files that the text names.
//
//   read_tables --flags    prints the flags of results instead, as JSON

#include <filesystem>
#include <iostream>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "services/bench/file/asked_keys.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/bench/file/reference_file.hpp"
#include "services/evaluation/result/result_flag.hpp"
#include "services/views/lab_file/laboratory_file.hpp"
#include "services/views/lab_file/sensor_file.hpp"
#include "services/views/lab_file/tolerance_table.hpp"
#include "services/views/objections/refusing_flags.hpp"

namespace dyncal {
namespace {

using Json = nlohmann::ordered_json;

template <class File>
std::string problem_of(const Expected<File>& file) {
  return file ? "" : file.error().message;
}

std::string read(const std::string& reader, const std::string& text, const std::string& path) {
  if (reader == "bench") {
    return problem_of(parse_bench_file(text, path));
  }
  if (reader == "reference") {
    const std::filesystem::path file(path);
    NamedFiles files(file.parent_path(), NamedFiles::Place::as_named);
    return problem_of(parse_reference_file(text, file.filename().string(), files));
  }
  if (reader == "laboratory") {
    return problem_of(parse_laboratory_file(text, path));
  }
  return reader == "sensor" ? problem_of(parse_sensor_file(text, path))
                            : problem_of(parse_tolerance_file(text, path));
}

Json answer(const Json& question) {
  const AskedKeys asked;
  Json answer{{"problem", read(question.at("reader"), question.at("text"), question.at("path"))},
              {"asked", Json::array()}};
  for (const AskedKey& key : asked.all()) {
    answer["asked"].push_back({{"name", key.name},
                               {"type", key.type},
                               {"unit", key.unit},
                               {"default", key.value},
                               {"choices", key.choices}});
  }
  return answer;
}

Json flags() {
  Json all = Json::array();
  for (int i = 0; i <= static_cast<int>(ResultFlag::from_message); ++i) {
    const auto flag = static_cast<ResultFlag>(i);
    const FlagVerdict verdict = verdict_on(flag);
    all.push_back({{"name", name_of(flag)},
                   {"sentence", to_string(flag)},
                   {"explanation", explanation_of(flag)},
                   {"repeated", may_be_cured(flag)},
                   {"forbids", verdict.forbids},
                   {"reason", verdict.reason}});
  }
  return all;
}

} // namespace
} // namespace dyncal

int main(int argc, char** argv) {
  using namespace dyncal;
  if (argc > 1 && std::string_view(argv[1]) == "--flags") {
    std::cout << flags() << '\n';
    return 0;
  }
  std::string line;
  while (std::getline(std::cin, line)) {
    std::cout << answer(nlohmann::ordered_json::parse(line)) << '\n';
  }
}
