#include "services/programs/web/history_answers.hpp"

#include <chrono>
#include <future>
#include <vector>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
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

} // namespace
} // namespace dyncal::inline programs::web
