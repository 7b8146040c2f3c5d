#include "services/programs/web/history_answers.hpp"

#include <chrono>
#include <cmath>
#include <future>
#include <tuple>
#include <vector>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/records/store/sensor_library.hpp"
#include "services/records/store/store.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/records/store/example_results.hpp"
#include "tests/unit/services/records/store/silent_server.hpp"

namespace dyncal::inline programs::web {
namespace {

using testing::HasSubstr;

// As a visitor gets it, and how long it took.
struct Answer {
  std::string text;
  std::chrono::steady_clock::duration taken{};
};

Answer ask(HistoryAnswers& answers) {
  httplib::Request request;
  request.path = "/api/history";
  httplib::Response response;
  const auto begun = std::chrono::steady_clock::now();
  EXPECT_TRUE(answers.answer(request, response));
  return {response.body, std::chrono::steady_clock::now() - begun};
}

std::vector<Answer> ask_at_once(HistoryAnswers& answers, int visitors) {
  std::vector<std::future<Answer>> asked;
  asked.reserve(static_cast<std::size_t>(visitors));
  for (int i = 0; i < visitors; ++i) {
    asked.push_back(std::async(std::launch::async, [&] { return ask(answers); }));
  }
  std::vector<Answer> got;
  for (std::future<Answer>& one : asked) {
    got.push_back(one.get());
  }
  return got;
}

TEST(HistoryAnswers, AServerThatHangsHoldsOneVisitor) {
  const SilentServer server;
  HistoryAnswers answers(fmt::format("postgresql://lab@127.0.0.1:{}/dyncal", server.port()));
  const auto got = ask_at_once(answers, 40);
  if (got.front().text.find("has no PostgreSQL") != std::string::npos) {
    GTEST_SKIP() << got.front().text;
  }
  int held = 0;
  for (const Answer& one : got) {
    const bool at_once = one.text.find("the store is slow") != std::string::npos;
    held += at_once ? 0 : 1;
    EXPECT_LT(one.taken, at_once ? std::chrono::seconds(4) : std::chrono::seconds(15)) << one.text;
    EXPECT_THAT(one.text, HasSubstr("problem"));
  }
  EXPECT_EQ(held, 1);
}

TEST(HistoryAnswers, EveryVisitorOfAStoreThatWorksGetsAnAnswer) {
  const tests::TemporaryFolder folder;
  HistoryAnswers answers((folder.path() / "dyncal.sqlite").string());
  for (const Answer& one : ask_at_once(answers, 40)) {
    EXPECT_THAT(one.text, HasSubstr("\"runs\""));
    EXPECT_THAT(one.text, testing::Not(HasSubstr("the store is slow")));
  }
}

// U 0.2 % at 10 Hz, of which the reference alone is nearly all: a change of 0.2 % is one.
TEST(HistoryAnswers, TakeOutWhatBothResultsHaveInCommon) {
  const tests::TemporaryFolder folder;
  const std::string place = (folder.path() / "dyncal.sqlite").string();
  auto store = Store::open(place);
  ASSERT_TRUE(store) << store.error().message;
  for (const auto& [run, days, magnitude] :
       {std::tuple("r1", 0, 1.0), std::tuple("r2", 1, 1.002)}) {
    evaluation::RunOutcome outcome =
        tests::outcome_of({.run = run, .days = days, .magnitude = magnitude});
    outcome.results.front().budget.front().u_magnitude_rel = 0.9e-3; // of the reference
    const auto added =
        (*store)->add(folder.write(std::string(run) + ".json", tests::text_of(outcome)));
    ASSERT_TRUE(added) << added.error().message;
  }
  const auto library = SensorLibrary::open(place);
  ASSERT_TRUE(library && (*library)->add({{"[sensor]\nname = \"a\"\nmanufacturer = \"b\"\nmodel = "
                                           "\"c\"\nserial = \"SN-9\"\ninterval_months = 12\n",
                                           "s.toml"}},
                                         false));
  HistoryAnswers answers(place);
  httplib::Request request;
  request.path = "/api/history";
  request.params.emplace("sensor", "mpu-7");
  httplib::Response response;
  ASSERT_TRUE(answers.answer(request, response));
  const auto json = nlohmann::json::parse(response.body);
  EXPECT_EQ(json["sensors"], nlohmann::json({"mpu-7"}));
  ASSERT_EQ(json["due"].size(), 1U);
  EXPECT_EQ(json["due"][0]["serial"], "SN-9");
  EXPECT_TRUE(json["due"][0]["overdue"].get<bool>());
  double largest = 0.0;
  double with_all_of_u = 0.0; // at 20 Hz there is no budget
  for (const auto& one : json["en"]) {
    if (one["channel"] != "dau/acceleration_z") {
      continue; // the same in both
    }
    const double en = one["en_magnitude"];
    (one["frequency_text_hz"] == "10" ? largest : with_all_of_u) = en;
  }
  EXPECT_NEAR(with_all_of_u, 0.71, 0.01);
  EXPECT_NEAR(largest, 0.71 / std::sqrt(1.0 - 0.81), 0.02);
  ASSERT_FALSE(json["runs"].empty());
  for (const auto& run : json["runs"]) {
    EXPECT_NEAR(run["points"][0]["unwrapped_phase_rad"], -0.5, 1e-12);
  }
}

} // namespace
} // namespace dyncal::inline programs::web
