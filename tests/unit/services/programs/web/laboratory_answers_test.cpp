#include "services/programs/web/laboratory_answers.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/bus/memory/stepped_clock.hpp"
#include "tests/unit/services/network/messages.hpp"

namespace dyncal::inline programs::web {
namespace {

TEST(BenchAddress, DividesNameAndPart) {
  const auto divided = [](const char* path) {
    const auto address = bench_address(path);
    return address ? address->bench + "|" + address->part : "none";
  };
  EXPECT_EQ(divided("/api/bench/acc-1"), "acc-1|");
  EXPECT_EQ(divided("/api/bench/acc-1/run"), "acc-1|run");
  EXPECT_EQ(divided("/api/bench/a/b/signal"), "a/b|signal");
  EXPECT_EQ(divided("/api/bench/acc-1/figures"), "acc-1|figures");
  EXPECT_EQ(divided("/api/bench/run"), "run|");
  EXPECT_EQ(divided("/api/bench/acc-1/other"), "acc-1/other|");
  EXPECT_EQ(divided("/api/bench/"), "none");
  EXPECT_EQ(divided("/api/laboratory"), "none");
}

class FigureAnswers : public testing::Test {
protected:
  FigureAnswers() {
    cache_.change([](network::BusState& laboratory) {
      laboratory.take(network::measurement_of("acc-1", "r1", wire::MEASUREMENT_RUNNING));
      laboratory.take(network::result_of("acc-1", "r1", 1, 0.3));
    });
  }
  // Asks the bench with these parameters besides the channel.
  httplib::Response ask(const httplib::Params& parameters,
                        const std::string& channel = "dau/acceleration_z") {
    httplib::Request request;
    request.path = "/api/bench/acc-1/figures";
    request.params = parameters;
    request.params.emplace("channel", channel);
    httplib::Response response;
    EXPECT_TRUE(answers_.answer(request, response));
    return response;
  }
  std::string bars_of(const httplib::Params& parameters) {
    return nlohmann::json::parse(ask(parameters).body)["bars"];
  }

  bus::SteppedClock clock_;
  StateCache cache_{clock_, [](nlohmann::ordered_json&) {}};
  RunFiles files_{""};
  LaboratoryAnswers answers_{cache_, files_};
};

TEST_F(FigureAnswers, HaveTheBarsThatAreAskedForAndExpandedOnesOtherwise) {
  EXPECT_EQ(bars_of({}), "U");
  EXPECT_EQ(bars_of({{"bars", "U"}}), "U");
  EXPECT_EQ(bars_of({{"bars", "u"}, {"run", "r1"}}), "u");
  EXPECT_EQ(bars_of({{"bars", "none"}}), "none");
  EXPECT_EQ(ask({}).get_header_value("Content-Type"), "application/json");
}

TEST_F(FigureAnswers, RefuseUnknownBarsRunsAndChannels) {
  EXPECT_EQ(ask({{"bars", "k"}}).status, 400);
  EXPECT_EQ(ask({{"bars", ""}}).status, 400);
  EXPECT_EQ(ask({{"run", "r2"}}).status, 404);
  EXPECT_EQ(ask({}, "dau/nothing").status, 404);
  EXPECT_EQ(ask({}, "").status, 404);
}

} // namespace
} // namespace dyncal::inline programs::web
