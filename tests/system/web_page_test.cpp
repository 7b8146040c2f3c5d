// What dyncal-web tells of a whole run is what the run itself wrote, late visitors hear everything,
// and a program that has died shows.
#include <csignal>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"
#include "tests/system/web_visitor.hpp"

namespace dyncal::tests {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;
using namespace std::chrono_literals;

// The bench file with its files played at four times their speed.
std::filesystem::path played(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::filesystem::path path = file.parent_path() / "played.toml";
  std::ofstream out(path);
  for (std::string line; std::getline(in, line);) {
    out << line << '\n' << (line.starts_with("driver = ") ? "play = 4.0\n" : "");
  }
  return path;
}

// These members, the expanded uncertainty, and the flags.
void expect_equal(const json& expected, const json& shown, std::vector<std::string> keys) {
  keys.insert(keys.end(), {"flags", "flag_names", "k_magnitude", "nu_eff_magnitude", "U_magnitude",
                           "k_phase", "nu_eff_phase", "U_phase_rad", "U_phase_deg", "u_phase_deg",
                           "coverage_probability"});
  for (const std::string& key : keys) {
    ASSERT_TRUE(shown.contains(key)) << key;
    EXPECT_EQ(shown[key], expected[key]) << shown["channel"] << " " << key;
  }
}

void expect_points_of(const json& result, const json& run) {
  ASSERT_GT(result["points"].size(), 6U);
  ASSERT_EQ(run["points"].size(), result["points"].size());
  for (std::size_t i = 0; i < result["points"].size(); ++i) {
    const json& point = result["points"][i];
    expect_equal(point, run["points"][i],
                 {"channel", "step", "repetition", "frequency_text_hz", "frequency_hz",
                  "level_m_s2", "valid", "magnitude", "u_magnitude", "phase_rad", "u_phase_rad",
                  "unit", "lost"});
  }
}

void expect_means_of(const json& result, const json& run) {
  std::size_t count = 0;
  for (const json& mean : run["transfer_function"]) {
    ASSERT_LT(count, result["transfer_function"].size());
    expect_equal(result["transfer_function"][count++], mean,
                 {"channel", "frequency_text_hz", "frequency_hz", "level_m_s2", "magnitude",
                  "u_magnitude", "phase_rad", "u_phase_rad", "unwrapped_phase_rad",
                  "scatter_magnitude", "scatter_phase_rad", "repetitions"});
  }
  EXPECT_EQ(count, 9U);
  EXPECT_EQ(count, result["transfer_function"].size());
}

void expect_run_of(const json& result, const json& run) {
  expect_points_of(result, run);
  expect_means_of(result, run);
}

TEST(WebPage, TellsOfARunWhatItsResultFileDoesAndOfADeadSourceThatItIsGone) {
  const auto folder = fresh_folder("web-page");
  const auto bench = played(recorded_bench(folder, "shown", "3"));
  const std::string address = "/api/bench/shown";
  Laboratory laboratory(folder);
  laboratory.start("dyncal-analysis", {}, "fastdds");
  ProgramRun& sources = laboratory.start("dyncal-acs", {bench}, "cyclonedds");
  ProgramRun& early = laboratory.start("dyncal-web", {"--listen", "127.0.0.1:0"}, "cyclonedds");
  ProgramRun& run = laboratory.start(
      "dyncal", {"run", bench, "--run", "R1", "--output", folder / "result.json"}, "fastdds");
  // The analysis says that the run goes on, its conductor what is planned: either may come first.
  const json running = WebVisitor(early).ask_until(address, [](const json& answer) {
    return answer.value("state", "") == "running" && answer.value("step_count", json()).is_number();
  });
  EXPECT_EQ(running["state"], "running") << running;
  EXPECT_EQ(running["step_count"], 6);
  ASSERT_EQ(run.wait(patience), 0) << run.errors();
  const json result = read_json(folder / "result.json");
  const auto has_all = [&](const json& answer) {
    return answer.contains("transfer_function") &&
           answer["transfer_function"].size() == result["transfer_function"].size() &&
           answer["points"].size() == result["points"].size();
  };
  expect_run_of(result, WebVisitor(early).ask_until(address + "/run", has_all));

  ProgramRun& late = laboratory.start("dyncal-web", {"--listen", "127.0.0.1:0"}, "fastdds");
  expect_run_of(result, WebVisitor(late).ask_until(address + "/run", has_all));
  const json all = WebVisitor(late).ask_until(
      address, [](const json& answer) { return answer["sources"].size() == 2; });
  EXPECT_EQ(all["sources"].size(), 2U) << all;

  sources.send(SIGKILL);
  const auto killed = Clock::now();
  const json gone = WebVisitor(early).ask_until(
      address, [](const json& answer) { return answer["worst"]["severity"] == "stale"; });
  EXPECT_LT(Clock::now() - killed, 3s + 2s) << "a status comes every 500 ms, here on a busy host";
  EXPECT_EQ(gone["worst"]["severity"], "stale") << gone;
}

} // namespace
} // namespace dyncal::tests
