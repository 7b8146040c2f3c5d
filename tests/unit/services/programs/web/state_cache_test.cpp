#include "services/programs/web/state_cache.hpp"

#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/bus/memory/stepped_clock.hpp"
#include "tests/unit/services/network/messages.hpp"

namespace dyncal::inline programs::web {
namespace {

using Json = nlohmann::ordered_json;
using namespace std::chrono_literals;

class StateCacheTest : public testing::Test {
protected:
  template <class Message>
  void take(const Message& message) {
    cache_.change([&](network::BusState& laboratory) { laboratory.take(message); });
  }
  Text results(const std::string& run = "") {
    return cache_.results("acc-1", run, [this](const std::string&, Json& json) {
      ++made_;
      json["files"] = Json::array();
    });
  }
  bus::SteppedClock clock_;
  StateCache cache_{clock_, [](Json& json) { json["daemon"] = "here"; }};
  int made_ = 0;
};

TEST_F(StateCacheTest, MakesATextOnceForAllWhoAsk) {
  take(network::status_of("acc-1", "dau"));
  const Text first = cache_.laboratory();
  take(network::status_of("acc-2", "dau"));
  EXPECT_EQ(cache_.laboratory(), first);
  clock_.advance(StateCache::text_age);
  const Json json = Json::parse(*cache_.laboratory());
  EXPECT_EQ(json["benches"].size(), 2U);
  EXPECT_EQ(json["daemon"], "here");
}

TEST_F(StateCacheTest, MakesResultsAnewWhenTheyChange) {
  EXPECT_EQ(results(), nullptr);
  take(network::measurement_of("acc-1", "r1", wire::MEASUREMENT_RUNNING));
  take(network::result_of("acc-1", "r1", 1, 0.3));
  const Text first = results();
  ASSERT_NE(first, nullptr);
  clock_.advance(10s);
  EXPECT_EQ(results(), first);
  EXPECT_EQ(made_, 1);
  const std::uint64_t number = cache_.results_number("acc-1");
  take(network::result_of("acc-1", "r1", 2, 0.4));
  EXPECT_NE(cache_.results_number("acc-1"), number);
  const Json json = Json::parse(*results());
  EXPECT_EQ(json["points"].size(), 2U);
  EXPECT_EQ(json["points"][1]["magnitude"], 0.4);
  EXPECT_EQ(json["runs"][0]["run"], "r1");
  EXPECT_EQ(results("r2"), nullptr);
}

TEST_F(StateCacheTest, MakesFiguresOnceForEachChannelAndChange) {
  using dyncal::figures::ErrorBars;
  const auto figures = [this](ErrorBars bars, const std::string& channel = "dau/acceleration_z") {
    return cache_.figures("acc-1", "", channel, bars);
  };
  EXPECT_EQ(figures(ErrorBars::expanded), nullptr);
  take(network::measurement_of("acc-1", "r1", wire::MEASUREMENT_RUNNING));
  EXPECT_EQ(figures(ErrorBars::expanded), nullptr);
  take(network::result_of("acc-1", "r1", 1, 0.3));
  const Text first = figures(ErrorBars::expanded);
  ASSERT_NE(first, nullptr);
  clock_.advance(10s);
  EXPECT_EQ(figures(ErrorBars::expanded), first);
  EXPECT_NE(*figures(ErrorBars::standard), *first);
  EXPECT_EQ(figures(ErrorBars::expanded, "dau/other"), nullptr);
  EXPECT_EQ(cache_.figures("acc-1", "r2", "dau/acceleration_z", ErrorBars::none), nullptr);

  const Json json = Json::parse(*first);
  EXPECT_EQ(json["run"], "r1");
  EXPECT_EQ(json["channel"], "dau/acceleration_z");
  EXPECT_EQ(json["bars"], "U");
  EXPECT_EQ(json["number"], Json::parse(*results())["number"]);
  ASSERT_EQ(json["pictures"].size(), 2U);
  const Json& points = json["pictures"][0]["panels"][0]["series"][1]["points"];
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0][0], 16.0);
  EXPECT_EQ(points[0][1], 0.3);
  EXPECT_GT(points[0][2], 1e-4); // U, not u
  EXPECT_EQ(points[0][3], 1);    // step

  take(network::result_of("acc-1", "r1", 2, 0.4));
  const Text second = figures(ErrorBars::expanded);
  EXPECT_NE(second, first);
  EXPECT_GT(Json::parse(*second)["number"], json["number"]);
}

// As many results as before do not make them the same: the texts that were kept are of another run.
TEST_F(StateCacheTest, ShowsARunThatWasDroppedAndIsHeardOfAgainAsItIsNow) {
  const auto figures = [this] {
    return cache_.figures("acc-1", "r1", "dau/acceleration_z",
                          dyncal::figures::ErrorBars::expanded);
  };
  const auto drop = [this](const std::string& others) {
    for (std::size_t i = 0; i < network::Limits{}.runs; ++i) {
      clock_.advance(1s);
      take(network::result_of("acc-1", others + std::to_string(i), 1, 0.5));
    }
    clock_.advance(1s);
    ASSERT_EQ(results("r1"), nullptr);
  };
  take(network::measurement_of("acc-1", "r1", wire::MEASUREMENT_DONE));
  const Json planned = Json::parse(*results("r1"));
  drop("a");
  take(network::result_of("acc-1", "r1", 1, 0.3));
  const Json first = Json::parse(*results("r1"));
  EXPECT_EQ(first["points"][0]["magnitude"], 0.3);
  EXPECT_GT(first["number"], planned["number"]);
  const Text picture = figures();
  const std::uint64_t number = cache_.results_number("acc-1");
  drop("b");
  take(network::result_of("acc-1", "r1", 1, 0.9));
  const Json second = Json::parse(*results("r1"));
  EXPECT_EQ(second["points"][0]["magnitude"], 0.9);
  EXPECT_GT(second["number"], first["number"]);
  ASSERT_NE(figures(), nullptr);
  EXPECT_NE(*figures(), *picture);
  EXPECT_EQ(Json::parse(*figures())["pictures"][0]["panels"][0]["series"][1]["points"][0][1], 0.9);
  EXPECT_NE(cache_.results_number("acc-1"), number);
}

// Nothing has come of either: what is known of them is the plan.
TEST_F(StateCacheTest, ShowsThePlanOfARunThatIsHeardOfAgain) {
  wire::Measurement first = network::measurement_of("acc-1", "r1", wire::MEASUREMENT_ABORTED);
  first.message("the first");
  take(first);
  const Text old = results("r1");
  for (std::size_t i = 0; i < network::Limits{}.runs; ++i) {
    clock_.advance(1s);
    take(network::result_of("acc-1", "other" + std::to_string(i), 1, 0.5));
  }
  wire::Measurement second = network::measurement_of("acc-1", "r1", wire::MEASUREMENT_RUNNING);
  second.message("the second");
  take(second);
  EXPECT_NE(*results("r1"), *old);
}

// A run's texts go with it, whoever has asked for them: what stays does not grow with the runs.
TEST_F(StateCacheTest, HoldsTextsOfTheRunsItHoldsOnly) {
  StateCache::Held most;
  StateCache::Held after_300; // then the list of events is full
  for (int i = 0; i < 1000; ++i) {
    const std::string run = "r" + std::to_string(i);
    take(network::measurement_of("acc-1", run, wire::MEASUREMENT_DONE));
    for (std::uint32_t step = 1; step <= 8; ++step) {
      take(network::result_of("acc-1", run, step, 0.3));
    }
    clock_.advance(1s);
    ASSERT_NE(results(run), nullptr);
    ASSERT_NE(cache_.figures("acc-1", run, "dau/acceleration_z", dyncal::figures::ErrorBars::none),
              nullptr);
    ASSERT_NE(cache_.laboratory(), nullptr);
    most.texts = std::max(most.texts, cache_.held().texts);
    most.bytes = std::max(most.bytes, cache_.held().bytes);
    after_300 = i == 299 ? cache_.held() : after_300;
  }
  EXPECT_LE(most.texts, 2 * network::Limits{}.runs + 1);
  EXPECT_GE(most.texts, 2 * network::Limits{}.runs) << "what is shown is held";
  EXPECT_GT(after_300.bytes, 10'000U);
  EXPECT_LT(most.bytes, after_300.bytes + after_300.bytes / 10);
}

TEST_F(StateCacheTest, ForgetsWhatNobodyAsksFor) {
  take(network::measurement_of("acc-1", "r1", wire::MEASUREMENT_RUNNING));
  take(network::result_of("acc-1", "r1", 1, 0.3));
  const Text first = results();
  for (int i = 0; i < 10; ++i) { // somebody looks: it is made once
    clock_.advance(StateCache::forgotten_after / 2);
    take(network::status_of("acc-1", "dau"));
    EXPECT_EQ(results(), first);
  }
  EXPECT_EQ(made_, 1);
  clock_.advance(StateCache::forgotten_after);
  take(network::status_of("acc-1", "dau"));
  EXPECT_EQ(cache_.held().texts, 0U);
  EXPECT_EQ(cache_.held().bytes, 0U);
  ASSERT_NE(results(), nullptr);
  EXPECT_EQ(cache_.held().texts, 1U);
}

TEST_F(StateCacheTest, HasNoTextOfABenchThatIsNotKnown) {
  EXPECT_EQ(cache_.bench("acc-1"), nullptr);
  take(network::status_of("acc-1", "dau"));
  EXPECT_EQ(Json::parse(*cache_.bench("acc-1"))["sources"].size(), 1U);
}

} // namespace
} // namespace dyncal::inline programs::web
