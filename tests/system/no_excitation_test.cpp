// Files of which nothing was excited, or of which a sync signal is missing, by the commands that
// take them: each names its own cause.
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* question = "is the sync signal connected?";

// As a cable that ends in nothing: a digit or two of noise.
void silence(const fs::path& file, const std::vector<std::string>& columns) {
  std::ifstream in(file);
  std::string text, line;
  std::vector<bool> silent;
  std::mt19937 random(1);
  while (std::getline(in, line)) {
    std::stringstream cells(line);
    std::string cell, out;
    for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
      if (text.empty()) {
        silent.push_back(std::find(columns.begin(), columns.end(), cell) != columns.end());
      } else if (silent.at(i)) {
        cell = fmt::format("{}e-4", random() % 4);
      }
      out += (i > 0 ? "," : "") + cell;
    }
    text += out + "\n";
  }
  ASSERT_EQ(static_cast<std::size_t>(std::count(silent.begin(), silent.end(), true)),
            columns.size());
  std::ofstream(file) << text;
}

class NoExcitationInFiles : public testing::Test {
protected:
  fs::path folder_ = fresh_folder(
      std::string("no-excitation-") +
      testing::UnitTest::GetInstance()->current_test_info()->name()); // another one may run beside
  fs::path bench_ = recorded_bench(folder_, "files", "3");

  std::vector<std::string> problems(const std::vector<std::string>& command) {
    fs::remove(folder_ / "result.json");
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.end(), {bench_, "--output", folder_ / "result.json"});
    Laboratory laboratory(folder_);
    if (command.front() == "run") {
      laboratory.start("dyncal-analysis", {}, "cyclonedds");
      laboratory.start("dyncal-acs", {bench_}, "cyclonedds");
    }
    ProgramRun alone("dyncal",
                     command.front() == "run" ? std::vector<std::string>{"--version"} : arguments,
                     folder_);
    ProgramRun& run =
        command.front() == "run" ? laboratory.start("dyncal", arguments, "cyclonedds") : alone;
    EXPECT_TRUE(run.wait(patience)) << run.errors();
    std::vector<std::string> problems;
    const json result = read_json(folder_ / "result.json");
    for (const json& point : result["points"]) {
      problems.push_back(point["problem"]);
      EXPECT_FALSE(point["valid"].get<bool>());
      EXPECT_THAT(run.output() + run.errors(), HasSubstr(problems.back()));
    }
    return problems;
  }
};

TEST_F(NoExcitationInFiles, IsNamedByAnalyseAndByRun) {
  silence(folder_ / "acs.csv", {"reference", "sync"});
  silence(folder_ / "dau.csv", {"acceleration_x", "acceleration_y", "acceleration_z", "sync"});
  for (const char* command : {"analyse", "run"}) {
    const auto said = problems({command});
    ASSERT_FALSE(said.empty()) << command;
    for (const std::string& problem : said) {
      EXPECT_THAT(problem, HasSubstr(": no excitation was found in acs/reference, acs/sync, "));
      EXPECT_THAT(problem, Not(HasSubstr(question)));
    }
  }
}

TEST_F(NoExcitationInFiles, IsNotSaidWhereSyncIsMissing) {
  silence(folder_ / "dau.csv", {"sync"});
  const auto said = problems({"analyse"});
  ASSERT_FALSE(said.empty());
  for (const std::string& problem : said) {
    EXPECT_THAT(problem, HasSubstr("found in dau/sync, where acs/sync shows one"));
    EXPECT_THAT(problem, HasSubstr(question));
  }
}

} // namespace
} // namespace dyncal::tests
