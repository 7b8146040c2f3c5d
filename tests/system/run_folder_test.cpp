// What a live run leaves on the disk: its folder, whole at any instant and refused before the
// exciter moves; and its entry in the store.
//
// DYNCAL_KILLS: how often a run is killed (default 4, by hand 100).
#include <csignal>
#include <cstdlib>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

LiveBenchSettings quick_bench() {
  LiveBenchSettings settings;
  settings.bench_arguments = {"--speed", "8"};
  settings.excitation = R"(frequencies_hz = ["20", "40", "80", "160"]
level = 10.0
repetitions = 3
settling_s = 0.5
duration_s = 1.0
)";
  return settings;
}

std::vector<fs::path> run_folders(const fs::path& runs) {
  std::vector<fs::path> folders;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(runs / "live", none)) {
    folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

std::string text_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// The number in the last line of the log that says how many results are in the file.
std::size_t results_promised(const fs::path& folder) {
  const std::string log = text_of(folder / "log.txt");
  const std::size_t end = log.rfind(" results are in result.json");
  if (end == std::string::npos) {
    return 0;
  }
  return std::stoul(log.substr(log.rfind(' ', end - 1) + 1));
}

// The values of the steps to `last`, as text with every digit.
std::set<std::string> values_to(int last, const nlohmann::json& result) {
  std::set<std::string> values;
  for (const auto& point : result["points"]) {
    if (point["valid"].get<bool>() && point["step"].get<int>() <= last) {
      values.insert(fmt::format("{} {} {} {}", point["step"].get<int>(),
                                point["channel"].get<std::string>(), point["magnitude"].dump(),
                                point["phase_rad"].dump()));
    }
  }
  return values;
}

TEST(RunFolder, HoldsWhatTheRunWasMadeFromAndWhatCameOut) {
  const auto folder = fresh_folder("run-folder");
  LiveBench bench(folder, quick_bench());
  ProgramRun& run = bench.start({"run", bench.bench_file(), "--run", "monday", "--output",
                                 folder / "asked-for.json", "--folder", folder / "kept"});
  ASSERT_EQ(run.wait(patience), 0) << run.errors();
  const auto folders = run_folders(folder / "kept");
  ASSERT_EQ(folders.size(), 1U);
  EXPECT_THAT(folders[0].filename().string(),
              testing::MatchesRegex("monday.[0-9]{8}T[0-9]{6}.*Z.[0-9a-f]{8}"));
  EXPECT_THAT(run.output(), HasSubstr("kept in " + folders[0].string()));
  EXPECT_THAT(run.errors(), testing::ContainsRegex("needs about [0-9.]+ MB there, .* are free"));
  EXPECT_EQ(text_of(folders[0] / "bench.toml"), text_of(bench.bench_file()));
  EXPECT_EQ(text_of(folders[0] / "result.json"), text_of(folder / "asked-for.json"));
  EXPECT_TRUE(fs::exists(folders[0] / "figures/transfer-function-dau-acceleration_z.svg"));
  EXPECT_EQ(results_promised(folders[0]), 36U); // 12 steps, 3 channels
  EXPECT_THAT(text_of(folders[0] / "log.txt"), HasSubstr("step 12 of 12, 160 Hz"));

  const auto again_json = folder / "again.json";
  ProgramRun again("dyncal", {"analyse", folders[0], "--output", again_json}, folder);
  ASSERT_EQ(again.wait(patience), 0) << again.errors();
  const auto result = read_json(folders[0] / "result.json");
  const auto repeated = read_json(again_json);
  EXPECT_EQ(result["points"], repeated["points"]);
  EXPECT_EQ(result["transfer_function"], repeated["transfer_function"]);

  const auto query = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--folder", folder / "kept"});
    const auto place = folder / arguments.front();
    fs::create_directories(place);
    ProgramRun program("dyncal", arguments, place);
    EXPECT_EQ(program.wait(patience), 0) << program.errors();
    return program.output();
  };
  const auto runs = nlohmann::json::parse(query({"runs", "--json"}), nullptr, false);
  ASSERT_EQ(runs["runs"].size(), 1U);
  EXPECT_TRUE(std::string(runs["runs"][0]["run"]).starts_with("monday."));
  EXPECT_EQ(runs["runs"][0]["state"], "complete");
  EXPECT_THAT(query({"store", "add", folders[0]}), HasSubstr("already there"));
  const auto history = nlohmann::json::parse(query({"history", "dau", "--json"}), nullptr, false);
  EXPECT_EQ(history["calibrations"].size(), 1U);
  EXPECT_EQ(history["lines"].size(), 12U); // 4 frequencies, 3 channels
}

// One of its files stood in another folder.
TEST(RunFolder, IsEvaluatedAgainWhenItsBenchIsGone) {
  const auto folder = fresh_folder("run-folder-again");
  fs::create_directories(folder / "lab");
  const auto bench = recorded_bench(folder / "lab", "live", "3");
  fs::rename(folder / "lab/acs.csv", folder / "acs.csv");
  std::string text = text_of(bench);
  text.replace(text.find("\"acs.csv\""), 9, "\"../acs.csv\"");
  std::ofstream(bench) << text;
  {
    Laboratory laboratory(folder);
    laboratory.start("dyncal-analysis", {}, "fastdds");
    laboratory.start("dyncal-acs", {bench}, "fastdds");
    ProgramRun& run =
        laboratory.start("dyncal", {"run", bench, "--folder", folder / "kept"}, "fastdds");
    ASSERT_EQ(run.wait(patience), 0) << run.errors();
  }
  fs::remove_all(folder / "lab");
  fs::remove(folder / "acs.csv");
  const auto folders = run_folders(folder / "kept");
  ASSERT_EQ(folders.size(), 1U);
  ProgramRun again("dyncal", {"analyse", folders[0], "--output", folder / "again.json"}, folder);
  ASSERT_EQ(again.wait(patience), 0) << again.errors();
  const auto first = read_json(folders[0] / "result.json");
  const auto second = read_json(folder / "again.json");
  ASSERT_EQ(first["points"].size(), 18U);
  EXPECT_EQ(first["points"], second["points"]);
  EXPECT_EQ(first["transfer_function"], second["transfer_function"]);
  EXPECT_EQ(first["recipe_sha256"], second["recipe_sha256"]);
}

TEST(RunFolder, IsRefusedBeforeTheExciterMoves) {
  const auto folder = fresh_folder("run-folder-refused");
  LiveBench bench(folder, quick_bench());
  std::ofstream(folder / "file") << "x";
  for (const fs::path& root : {folder / "file", fs::path("/proc/runs")}) {
    ProgramRun& run = bench.start({"run", bench.bench_file(), "--folder", root});
    EXPECT_EQ(run.wait(patience), 1);
    EXPECT_THAT(run.errors(), HasSubstr("the run folder cannot be made"));
    EXPECT_THAT(run.errors(), Not(HasSubstr("step 1 of")));
  }
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");
}

TEST(RunFolder, IsTheTruthWhereTheStoreCannotBeWritten) {
  const auto folder = fresh_folder("run-folder-store");
  LiveBench bench(folder, quick_bench());
  ProgramRun& run = bench.start(
      {"run", bench.bench_file(), "--folder", folder / "kept", "--store", "/proc/x.db"});
  EXPECT_EQ(run.wait(patience), 0) << run.errors();
  const auto folders = run_folders(folder / "kept");
  ASSERT_EQ(folders.size(), 1U);
  EXPECT_THAT(run.errors(), HasSubstr("dyncal store add " + folders[0].string()));
  EXPECT_EQ(read_json(folders[0] / "result.json")["points"].size(), 36U);
}

TEST(RunFolder, HasEveryResultItPromisedWhenTheRunIsKilled) {
  const auto folder = fresh_folder("run-folder-killed");
  LiveBench bench(folder, quick_bench());
  const char* wished = std::getenv("DYNCAL_KILLS");
  const int kills = wished == nullptr ? 4 : std::atoi(wished);
  std::mt19937 random(20261122);
  std::uniform_int_distribution<int> any_step(1, 10);
  std::uniform_int_distribution<int> any_ms(0, 300);
  int expected = 0; // runs with a step that was over long before
  int with_results = 0;
  for (int i = 0; i < kills; ++i) {
    const fs::path runs = folder / ("runs-" + std::to_string(i));
    ProgramRun& run = bench.start({"run", bench.bench_file(), "--wait", "--folder", runs});
    const int step = any_step(random);
    ASSERT_TRUE(run.wait_for_error_text(fmt::format("step {} of 12", step), patience))
        << run.errors();
    static_cast<void>(run.wait(std::chrono::milliseconds(any_ms(random)))); // then it is killed
    run.send(SIGKILL);
    EXPECT_EQ(run.wait(patience), 128 + SIGKILL);
    const auto folders = run_folders(runs);
    ASSERT_EQ(folders.size(), 1U);
    const auto result = read_json(folders[0] / "result.json");
    ASSERT_FALSE(result.is_discarded()) << folders[0];
    EXPECT_GE(result["points"].size(), results_promised(folders[0]));
    EXPECT_THAT(result["problem"].get<std::string>(), HasSubstr("has not ended"));
    EXPECT_EQ(text_of(folders[0] / "bench.toml"), text_of(bench.bench_file()));
    const auto again_json = folder / "again.json";
    fs::remove(again_json);
    ProgramRun again("dyncal", {"analyse", folders[0], "--output", again_json}, folder);
    EXPECT_TRUE(again.wait(patience)); // not well: the run has not all of its steps
    const auto repeated = read_json(again_json);
    ASSERT_FALSE(repeated.is_discarded()) << again.errors();
    // A recording has what came to a second before; six steps of this bench take longer.
    EXPECT_THAT(values_to(12, repeated), testing::IsSupersetOf(values_to(step - 6, result)));
    expected += step > 3 ? 1 : 0;
    with_results += step > 3 && !result["points"].empty() ? 1 : 0;
    ASSERT_TRUE(bench.wait_for_output("OFF"));
  }
  EXPECT_EQ(with_results, expected);
  EXPECT_GT(expected, 0);
  RecordProperty("kills", kills);
}

} // namespace
} // namespace dyncal::tests
