// What a visitor with the token does to a real bench: starts a run, has a step excited once more,
// pauses, goes on and aborts; then reads the run's files and the history of its sensor.
#include <algorithm>
#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"
#include "tests/system/test_folder.hpp"
#include "tests/system/web_visitor.hpp"

namespace dyncal::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

constexpr const char* token = "a secret of the laboratory";
const std::string address = "/api/bench/live";

LiveBenchSettings short_run() {
  LiveBenchSettings settings;
  settings.excitation = R"(frequencies_hz = ["20", "40", "80"]
level = 10.0
repetitions = 2
settling_s = 0.5
duration_s = 1.0
)";
  return settings;
}

std::string text_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class WebActions : public testing::Test {
protected:
  WebActions() {
    std::ofstream(folder_ / "token") << token << '\n';
    fs::permissions(folder_ / "token", fs::perms::owner_read);
    web_ = &services_.start("dyncal-web",
                            {"--listen", "127.0.0.1:0", "--token-file", folder_ / "token",
                             "--benches", folder_, "--runs", folder_ / "runs"},
                            "fastdds");
    visitor_.emplace(*web_, token);
  }
  json command(const std::string& word, const std::string& run, int step = 0) {
    json body{{"command", word}, {"run", run}};
    if (step > 0) {
      body["step"] = step;
    }
    return visitor_->post(address + "/command", body);
  }
  json bench_until(const WebVisitor::Holds& holds) { return visitor_->ask_until(address, holds); }
  // Its name, once `steps` steps of it are done. Empty `name`: the time.
  std::string started_run(int steps, const std::string& name = "") {
    const json started = visitor_->post(
        "/api/run", {{"file", "bench.toml"}, {"run", name}, {"operator", "A. Meter"}});
    if (started["status"] != 200) {
      ADD_FAILURE() << started;
      return "";
    }
    const json running = bench_until([&](const json& bench) {
      return bench["state"] == "running" && bench["steps_done"].is_number() &&
             bench["steps_done"] >= steps;
    });
    EXPECT_EQ(running["state"], "running") << running;
    return running["run"].is_string() ? running["run"].get<std::string>() : "";
  }

  fs::path folder_ = fresh_folder_of_this_test();
  LiveBench bench_{folder_, short_run()};
  Laboratory services_{folder_};
  ProgramRun* web_ = nullptr;
  std::optional<WebVisitor> visitor_;
};

// From the recording, with the pause and the step that was excited twice.
void expect_same_again(const fs::path& run_folder) {
  const fs::path again = run_folder.parent_path() / "again.json";
  ProgramRun analyse("dyncal", {"analyse", run_folder, "--output", again},
                     run_folder.parent_path());
  ASSERT_EQ(analyse.wait(patience), 0) << analyse.errors();
  const json live = read_json(run_folder / "result.json");
  const json repeated = read_json(again);
  EXPECT_EQ(repeated["points"], live["points"]);
  EXPECT_EQ(repeated["transfer_function"], live["transfer_function"]);
  ASSERT_EQ(live["pauses"].size(), 1U);
  ASSERT_EQ(repeated["pauses"].size(), 1U);
  EXPECT_EQ(repeated["pauses"][0]["reason"], live["pauses"][0]["reason"]);
  EXPECT_NE(repeated["pauses"][0]["ended_utc"], nullptr);
}

TEST_F(WebActions, ConductARun) {
  const json too_long =
      visitor_->post("/api/run", {{"file", "bench.toml"}, {"comment", std::string(201, 'x')}});
  EXPECT_EQ(too_long["status"], 400) << too_long;
  const std::string run = started_run(1, "first-run");
  ASSERT_THAT(run, testing::StartsWith("first-run."));
  EXPECT_EQ(command("pause", run)["message"], "pause: done");
  const json paused = bench_until([](const json& bench) { return bench["state"] == "paused"; });
  EXPECT_EQ(paused["state"], "paused") << paused;
  EXPECT_THAT(paused["message"], HasSubstr("dyncal-web"));
  const json spectrum =
      visitor_->ask_until(address + "/spectrum?source=acs&channel=reference&seconds=2",
                          [](const json& answer) { return answer.contains("noise_floor"); });
  EXPECT_TRUE(spectrum["noise_floor"].is_number()) << spectrum;
  EXPECT_TRUE(spectrum["thd"].is_null()) << "nothing is excited: " << spectrum;

  // Nothing goes on meanwhile.
  const json second = visitor_->post("/api/run", {{"file", "bench.toml"}});
  EXPECT_EQ(second["status"], 409);
  EXPECT_THAT(second["message"], HasSubstr("under way"));

  const json asked = command("repeat", run, 1);
  EXPECT_EQ(asked["status"], 200) << asked;
  EXPECT_THAT(asked["message"], HasSubstr("step 1 is excited once more"));
  const json unknown = command("repeat", run, 99);
  EXPECT_EQ(unknown["status"], 409);
  EXPECT_THAT(unknown["message"], HasSubstr("no step 99"));
  EXPECT_EQ(command("continue", "another run")["status"], 409);

  EXPECT_EQ(command("continue", run)["message"], "continue: done");

  const json done = bench_until([](const json& bench) { return bench["state"] == "done"; });
  ASSERT_EQ(done["state"], "done") << done;
  const json all = visitor_->ask_until(address + "/run", [](const json& answer) {
    return answer.contains("transfer_function") && !answer["transfer_function"].empty();
  });
  std::size_t of_first_step = 0;
  for (const json& point : all["points"]) {
    if (point["step"] == 1) {
      ++of_first_step;
      EXPECT_EQ(point["attempt"], 2) << "asked for once, excited once more";
    }
  }
  EXPECT_GE(of_first_step, 3U);
  const auto of_excited_axis = std::ranges::find_if(all["transfer_function"], [](const json& one) {
    return one["channel"] == "dau/acceleration_z";
  });
  ASSERT_NE(of_excited_axis, all["transfer_function"].end());
  const json& mean = *of_excited_axis;
  EXPECT_NEAR(mean["measured_level_m_s2"], 10.0, 0.5) << mean;
  const std::string of_mean = "/budget?channel=" + mean["channel"].get<std::string>() +
                              "&frequency=" + mean["frequency_text_hz"].get<std::string>();
  const json budget = visitor_->ask(address + of_mean);
  EXPECT_GE(budget["contributions"].size(), 3U) << budget;
  double squares = 0.0;
  for (const json& row : budget["contributions"]) {
    squares += std::pow(row["u_magnitude_rel"].get<double>(), 2);
  }
  EXPECT_NEAR(std::sqrt(squares) * mean["magnitude"].get<double>() *
                  mean["k_magnitude"].get<double>() / mean["U_magnitude"].get<double>(),
              1.0, 1e-2);

  const fs::path kept = folder_ / "runs" / "live" / run;
  // Written as results come: what is compared is what stands when the run has ended.
  const auto is_whole = [this](const json& file) {
    if (file["name"] != "result.json") {
      return false;
    }
    const json result = visitor_->ask(file["href"]);
    return result.is_object() && !result["ended_utc"].is_null();
  };
  const json listed = visitor_->ask_until(address + "/run", [&](const json& answer) {
    return std::any_of(answer["files"].begin(), answer["files"].end(), is_whole);
  });
  std::size_t compared = 0;
  for (const json& file : listed["files"]) {
    const auto name = file["name"].get<std::string>();
    EXPECT_FALSE(name.ends_with(".part")) << name;
    if (name == "result.json" || name == "bench.toml") {
      EXPECT_EQ(visitor_->text(file["href"]), text_of(kept / name)) << name;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 2U) << listed["files"];

  EXPECT_EQ(read_json(kept / "result.json")["conducted_by"]["name"], "A. Meter");
  expect_same_again(kept);

  const json sensors = visitor_->ask_until(
      "/api/history?sensor=", [](const json& history) { return history["sensors"].size() >= 1; });
  ASSERT_EQ(sensors["sensors"].size(), 1U) << "of the instruments the sensor alone: " << sensors;
  const json history = visitor_->ask_until(
      "/api/history?sensor=" + httplib::detail::encode_query_param(sensors["sensors"][0]),
      [](const json& answer) { return answer["runs"].size() >= 3; });
  ASSERT_EQ(history["runs"].size(), 3U) << "one for every channel with a result: " << history;
  for (const json& calibration : history["runs"]) {
    EXPECT_EQ(calibration["run"], run);
    EXPECT_EQ(calibration["points"].size(), 3U);
  }
}

TEST_F(WebActions, AbortARunWhichSwitchesTheOutputOff) {
  const std::string run = started_run(0);
  ASSERT_NE(run, "");
  EXPECT_TRUE(bench_.wait_for_output("ON"));
  const json aborted = command("abort", run);
  EXPECT_EQ(aborted["message"], "abort: done") << aborted;
  EXPECT_TRUE(bench_.wait_for_output("OFF"));
  const json ended = bench_until([](const json& bench) { return bench["state"] == "aborted"; });
  EXPECT_EQ(ended["state"], "aborted") << ended;
  EXPECT_EQ(command("abort", run)["status"], 409) << "nobody conducts it any more";
  EXPECT_THAT(web_->errors(), HasSubstr("/api/bench/live/command of 127.0.0.1: 200"));
  EXPECT_THAT(web_->errors(), HasSubstr("/api/bench/live/command of 127.0.0.1: 409"));
}

} // namespace
} // namespace dyncal::tests
