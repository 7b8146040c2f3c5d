// What dyncal-web tells of a whole run is what the run itself wrote, late visitors hear everything,
// and a program that has died shows.
#include <csignal>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>
#include <httplib.h>

#include "services/bus/wake_up.hpp"
#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;
using namespace std::chrono_literals;

// "page at http://127.0.0.1:PORT/"
int port_of(const ProgramRun& web) {
  const std::string log = web.errors();
  const std::string begin = "page at http://127.0.0.1:";
  return std::stoi(log.substr(log.find(begin) + begin.size()));
}

json ask(int port, const std::string& address) {
  httplib::Client client("127.0.0.1", port);
  client.set_read_timeout(20s);
  const auto answer = client.Get(address);
  return answer ? json::parse(answer->body, nullptr, false) : json();
}

// The first answer for which it holds, or the last one.
json ask_until(int port, const std::string& address,
               const std::function<bool(const json&)>& holds) {
  const auto end = Clock::now() + patience;
  bus::WakeUp pacing;
  json answer = ask(port, address);
  while (!holds(answer) && Clock::now() < end) {
    pacing.wait_until(Clock::now() + 50ms);
    answer = ask(port, address);
  }
  return answer;
}

// The bench file with its files played at four times their speed.
std::filesystem::path played(const std::filesystem::path& file) {
  std::ifstream in(file);
  const std::filesystem::path path = file.parent_path() / "played.toml";
  std::ofstream out(path);
  for (std::string line; std::getline(in, line);) {
    out << line << '\n' << (line.starts_with("driver = ") ? "play = 4.0\n" : "");
  }
  return path;
}

void expect_points_of(const json& result, const json& run) {
  ASSERT_GT(result["points"].size(), 6U);
  ASSERT_EQ(run["points"].size(), result["points"].size());
  for (std::size_t i = 0; i < result["points"].size(); ++i) {
    const json& point = result["points"][i];
    for (const char* key :
         {"channel", "step", "repetition", "frequency_text_hz", "frequency_hz", "level_m_s2",
          "valid", "magnitude", "u_magnitude", "phase_rad", "u_phase_rad", "unit", "lost"}) {
      EXPECT_EQ(run["points"][i][key], point[key]) << i << " " << key;
    }
    EXPECT_EQ(run["points"][i]["flags"].size(), point["flags"].size());
  }
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
      "dyncal", {"run", bench, "--run", "R1", "--json", folder / "result.json"}, "fastdds");
  const json running = ask_until(port_of(early), address, [](const json& answer) {
    return answer.is_object() && answer.value("state", "") == "running";
  });
  EXPECT_EQ(running["state"], "running") << running;
  EXPECT_EQ(running["step_count"], 6);
  ASSERT_EQ(run.wait(patience), 0) << run.errors();
  const json result = read_json(folder / "result.json");
  const auto has_all = [&](const json& answer) {
    return answer.is_object() && answer.contains("transfer") && !answer["transfer"].empty() &&
           answer["points"].size() == result["points"].size();
  };
  expect_points_of(result, ask_until(port_of(early), address + "/run", has_all));

  ProgramRun& late = laboratory.start("dyncal-web", {"--listen", "127.0.0.1:0"}, "fastdds");
  expect_points_of(result, ask_until(port_of(late), address + "/run", has_all));
  const json all = ask_until(port_of(late), address,
                             [](const json& answer) { return answer["sources"].size() == 2; });
  EXPECT_EQ(all["sources"].size(), 2U) << all;

  sources.send(SIGKILL);
  const auto killed = Clock::now();
  const json gone = ask_until(port_of(early), address, [](const json& answer) {
    return answer["worst"]["severity"] == "stale";
  });
  EXPECT_LT(Clock::now() - killed, 3s + 2s) << "a status comes every 500 ms, here on a busy host";
  EXPECT_EQ(gone["worst"]["severity"], "stale") << gone;
}

} // namespace
} // namespace dyncal::tests
