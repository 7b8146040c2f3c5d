#include "services/records/run_folder/result_keeper.hpp"

#include <chrono>
#include <fstream>
#include <functional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/patience.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/records/run_folder/size_limit.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace dyncal::inline records {
namespace {

using testing::HasSubstr;

class Keeper : public testing::Test {
protected:
  [[nodiscard]] nlohmann::json file() const {
    std::ifstream stream(path_);
    return nlohmann::json::parse(stream, nullptr, false);
  }
  static bool becomes_true(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + tests::patience;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > deadline) {
        return false;
      }
      std::this_thread::yield();
    }
    return true;
  }
  // A run of which `count` results have come, the newest first.
  static RunOutcome state(std::size_t count) {
    RunOutcome outcome = tests::example_outcome();
    outcome.problem.clear();
    outcome.ended_utc_ns = 0;
    outcome.transfer_functions.clear();
    outcome.results.clear();
    for (std::size_t step = count; step > 0; --step) {
      outcome.results.push_back(tests::example_result(static_cast<std::uint32_t>(step), "10"));
    }
    return outcome;
  }

  tests::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "result.json";
};

TEST_F(Keeper, HasAWholeFileBeforeTheFirstResult) {
  ResultKeeper keeper(path_);
  ASSERT_TRUE(keeper.begin(state(0)));
  const auto json = file();
  ASSERT_FALSE(json.is_discarded());
  EXPECT_THAT(json["problem"].get<std::string>(), HasSubstr("has not ended"));
  EXPECT_TRUE(json["points"].empty());
}

TEST_F(Keeper, WritesTheNewestStateInTheOrderOfSteps) {
  ResultKeeper keeper(path_);
  for (std::size_t count = 1; count <= 40; ++count) {
    keeper.keep(state(count));
  }
  ASSERT_TRUE(becomes_true([&] { return keeper.results_kept() == 40; }));
  const auto json = file();
  ASSERT_EQ(json["points"].size(), 40U);
  EXPECT_EQ(json["points"][0]["step"], 1);
  EXPECT_EQ(json["points"][39]["step"], 40);
}

// Results of the program before are there at once.
TEST_F(Keeper, BeginsAResumedRunWhileItsResultsCome) {
  for (std::size_t run = 0; run < 50; ++run) {
    ResultKeeper keeper(path_);
    keeper.keep(state(3));
    ASSERT_TRUE(keeper.begin(state(2)));
    ASSERT_TRUE(becomes_true([&] { return keeper.results_kept() == 3; }));
    EXPECT_EQ(file()["points"].size(), 3U);
    EXPECT_FALSE(keeper.problem());
  }
}

TEST_F(Keeper, NeverCountsMoreThanTheFileHas) {
  ResultKeeper keeper(path_);
  for (std::size_t count = 1; count <= 200; ++count) {
    keeper.keep(state(count));
    const std::size_t kept = keeper.results_kept();
    if (kept > 0) {
      const auto json = file();
      ASSERT_FALSE(json.is_discarded());
      ASSERT_GE(json["points"].size(), kept);
    }
  }
}

TEST_F(Keeper, ReportsAFullDiskKeepsTheOlderFileAndTriesAgain) {
  ResultKeeper keeper(path_);
  keeper.keep(state(1));
  ASSERT_TRUE(becomes_true([&] { return keeper.results_kept() == 1; }));
  {
    const tests::SizeLimit full(1000);
    keeper.keep(state(2));
    ASSERT_TRUE(becomes_true([&] { return keeper.problem().has_value(); }));
    EXPECT_THAT(keeper.problem()->message, HasSubstr("result.json: cannot be written"));
    EXPECT_EQ(file()["points"].size(), 1U);
    const auto begun = ResultKeeper(folder_.path() / "other.json").begin(state(0));
    ASSERT_FALSE(begun);
    EXPECT_EQ(begun.error().code, ErrorCode::bad_file);
  }
  keeper.keep(state(3));
  ASSERT_TRUE(becomes_true([&] { return keeper.results_kept() == 3; }));
  EXPECT_FALSE(keeper.problem());
}

TEST_F(Keeper, EndsWithTheFinalState) {
  ResultKeeper keeper(path_);
  keeper.keep(state(1));
  RunOutcome last = state(2);
  last.ended_utc_ns = 1'700'000'000'000'000'000;
  ASSERT_TRUE(keeper.finish(last));
  const auto json = file();
  EXPECT_EQ(json["points"].size(), 2U);
  EXPECT_EQ(json["problem"], "");
  EXPECT_FALSE(json["ended_utc"].is_null());
}

} // namespace
} // namespace dyncal::inline records
