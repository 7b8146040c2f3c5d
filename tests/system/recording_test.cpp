// A live run and its recording: `dyncal analyse` gives the same result from it, byte for byte but
// for times, whichever DDS implementation carried and recorded it.
#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

// A result file without its times, and without who conducted the run, which no recording knows.
std::vector<std::string> lines_without_times(const std::filesystem::path& path) {
  std::ifstream file(path);
  auto json = nlohmann::ordered_json::parse(file);
  for (const char* member : {"began_utc", "ended_utc", "conducted_by"}) {
    json.erase(member);
  }
  std::istringstream text(json.dump(1));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) {
    lines.push_back(line);
  }
  return lines;
}

struct Recorded {
  std::filesystem::path folder;
  std::filesystem::path bench;
  std::filesystem::path live; // its result
  std::filesystem::path recording;
};

// The bench file with its files played at four times their speed: a run that is over before the
// recorder has heard of its conductor is not recorded.
std::filesystem::path played(const std::filesystem::path& file) {
  std::ifstream in(file);
  const std::filesystem::path played = file.parent_path() / "played.toml";
  std::ofstream out(played);
  for (std::string line; std::getline(in, line);) {
    out << line << '\n' << (line.starts_with("driver = ") ? "play = 4.0\n" : "");
  }
  return played;
}

Recorded record_run(const std::string& name, const std::string& dds, const std::string& recorder) {
  Recorded run;
  run.folder = fresh_folder(name);
  run.bench = played(recorded_bench(run.folder, "files", "3"));
  run.live = run.folder / "live.json";
  Laboratory laboratory(run.folder);
  ProgramRun& service = laboratory.start(
      "dyncal-recorder", {"--folder", run.folder / "recordings", "--runs-only"}, recorder);
  laboratory.start("dyncal-analysis", {}, dds);
  laboratory.start("dyncal-acs", {run.bench}, dds);
  ProgramRun& command =
      laboratory.start("dyncal", {"run", run.bench, "--run", "R1", "--output", run.live}, dds);
  EXPECT_EQ(command.wait(patience), 0) << command.output() << command.errors();
  EXPECT_TRUE(service.wait_for_error_text(".mcap has", patience)) << service.errors();
  for (const auto& file : std::filesystem::directory_iterator(run.folder / "recordings/files")) {
    run.recording =
        file.path().filename().string().starts_with("R1.") ? file.path() : run.recording;
  }
  return run;
}

void expect_same_result(const Recorded& run) {
  const std::filesystem::path json = run.folder / "again.json";
  ProgramRun analyse("dyncal", {"analyse", run.recording, "--output", json}, run.folder);
  EXPECT_EQ(analyse.wait(patience), 0) << analyse.errors();
  const auto live = lines_without_times(run.live);
  const auto again = lines_without_times(json);
  ASSERT_GT(live.size(), 1000U);
  const auto [a, b] = std::mismatch(live.begin(), live.end(), again.begin(), again.end());
  EXPECT_TRUE(a == live.end() && b == again.end()) << (a == live.end() ? "" : *a) << "\nis now\n"
                                                   << (b == again.end() ? "" : *b);
}

TEST(Recording, GivesTheResultOfTheLiveRunOverFastDds) {
  expect_same_result(record_run("recording-fast", "fastdds", "fastdds"));
}

TEST(Recording, GivesTheResultOfTheLiveRunOverCycloneDdsRecordedByFastDds) {
  const Recorded run = record_run("recording-mixed", "cyclonedds", "fastdds");
  expect_same_result(run);
  ProgramRun check("dyncal", {"recording", "check", run.recording}, run.folder);
  EXPECT_EQ(check.wait(patience), 0) << check.output() << check.errors();
  EXPECT_NE(check.output().find("0 places are damaged"), std::string::npos);
  ProgramRun info("dyncal", {"recording", "info", run.recording}, run.folder);
  EXPECT_EQ(info.wait(patience), 0);
  EXPECT_NE(info.output().find("attachment recipe.toml"), std::string::npos) << info.output();
  EXPECT_NE(info.output().find("acs.missing = 0"), std::string::npos) << info.output();
}

// Another recipe: the first frequency alone is not in it.
TEST(Recording, IsEvaluatedByAnotherBenchFile) {
  const Recorded run = record_run("recording-recipe", "cyclonedds", "cyclonedds");
  std::ifstream file(run.bench);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::string stated = "reference_magnitude_rel = 5e-4";
  ASSERT_NE(text.find(stated), std::string::npos);
  text.replace(text.find(stated), stated.size(), "reference_magnitude_rel = 5e-2");
  const auto other = run.folder / "other.toml";
  std::ofstream(other) << text;
  const auto json = run.folder / "other.json";
  ProgramRun analyse("dyncal", {"analyse", run.recording, "--recipe", other, "--output", json},
                     run.folder);
  EXPECT_EQ(analyse.wait(patience), 0) << analyse.errors();
  const auto live = read_json(run.live);
  const auto again = read_json(json);
  ASSERT_EQ(again["points"].size(), live["points"].size());
  EXPECT_EQ(again["points"][0]["magnitude"], live["points"][0]["magnitude"]);
  EXPECT_GT(again["points"][0]["u_magnitude"].get<double>(),
            3.0 * live["points"][0]["u_magnitude"].get<double>());
}

TEST(Recording, IsRefusedWhenItIsNone) {
  const auto folder = fresh_folder("recording-none");
  std::ofstream(folder / "a.mcap") << "not a recording";
  ProgramRun analyse("dyncal", {"analyse", folder / "a.mcap"}, folder);
  EXPECT_NE(analyse.wait(patience), 0);
  EXPECT_NE(analyse.errors().find("a.mcap: at byte 0"), std::string::npos) << analyse.errors();
}

} // namespace
} // namespace dyncal::tests
