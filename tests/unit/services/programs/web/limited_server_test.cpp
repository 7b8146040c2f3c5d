// 400 connections of which each does next to nothing, and the one visitor who only wants the page.
#include "services/programs/web/limited_server.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "services/programs/web/limited_stream.hpp"
#include "services/programs/web/request_router.hpp"
#include "tests/unit/services/programs/web/raw_visitor.hpp"

namespace dyncal::inline programs::web {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr std::size_t slow_count = 400;
constexpr std::size_t big_bytes = std::size_t{64} * 1024 * 1024; // more than any kernel holds
constexpr std::chrono::seconds longest_wait{4}; // 2 s, and what a busy machine adds
const std::string get_page = "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";

class LimitedServerTest : public testing::Test {
protected:
  void SetUp() override {
    router_.on_get([](const httplib::Request& request, httplib::Response& response) {
      response.set_content_provider(big_bytes, "text/plain",
                                    [](std::size_t, std::size_t length, httplib::DataSink& sink) {
                                      static const std::string part(65536, 'a');
                                      return sink.write(part.data(), std::min(length, part.size()));
                                    });
      return request.path.starts_with("/files/");
    });
    ASSERT_TRUE(router_.start());
  }
  // Each writes this and then nothing, and reads nothing.
  [[nodiscard]] std::vector<RawVisitor> slow_visitors(std::size_t count, const std::string& bytes) {
    std::vector<RawVisitor> visitors;
    for (std::size_t i = 0; i < count; ++i) {
      visitors.emplace_back(router_.port(), 4096);
      EXPECT_TRUE(visitors.back().is_connected() && visitors.back().write(bytes)) << i;
    }
    return visitors;
  }
  // How long somebody waits for the page who comes now.
  [[nodiscard]] Clock::duration page_takes() const {
    const auto began = Clock::now();
    const RawVisitor visitor(router_.port());
    EXPECT_TRUE(visitor.write(get_page));
    EXPECT_TRUE(visitor.read().starts_with("HTTP/1.1 200"));
    return Clock::now() - began;
  }

  bus::Clock& clock_ = bus::system_clock();
  RequestRouter router_{
      {.listen = {"127.0.0.1", 0}, .own_names = {}, .javascript_folder = "", .guide_folder = ""},
      clock_};
};

TEST_F(LimitedServerTest, LetsNobodyWaitForThoseWhoSendSlowly) {
  for (const char* bytes :
       {"", "G", "GET / HTTP/1.1\r\nHost: localhost\r\nX: ",
        "POST /api/run HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
        "Content-Length: 60000\r\n\r\n{"}) {
    const auto visitors = slow_visitors(slow_count, bytes);
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT(page_takes(), longest_wait) << bytes;
    }
  }
}

TEST_F(LimitedServerTest, LetsNobodyWaitForThoseWhoTakeSlowly) {
  const auto visitors =
      slow_visitors(slow_count, "GET /files/a/b/c HTTP/1.1\r\nHost: localhost\r\n\r\n");
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(page_takes(), longest_wait);
  }
  EXPECT_GT(router_.refusals().of(Refusal::slow), slow_count / 2);
}

TEST_F(LimitedServerTest, ClosesTheOldestWhenMoreComeThanItHasRoomFor) {
  const auto visitors = slow_visitors(LimitedServer::max_connections + 100, "GET /");
  EXPECT_LT(page_takes(), longest_wait);
  EXPECT_GE(router_.refusals().of(Refusal::slow), 100U);
}

// The opposite: who is slow for a while, and keeps nobody out, is answered whole.
TEST_F(LimitedServerTest, AnswersASlowVisitorWhole) {
  const RawVisitor sender(router_.port());
  for (const char letter : get_page) {
    ASSERT_TRUE(sender.write(std::string(1, letter)));
  }
  EXPECT_TRUE(sender.read_all().ends_with("</html>\n"));

  const RawVisitor taker(router_.port(), 4096);
  ASSERT_TRUE(taker.write("GET /files/a/b/c HTTP/1.1\r\nHost: localhost\r\n"
                          "Connection: close\r\n\r\n"));
  std::string first = taker.read();
  const auto until = Clock::now() + 3 * LimitedStream::crowded_write_limit;
  while (Clock::now() < until) { // takes nothing, while others come and go
    EXPECT_LT(page_takes(), longest_wait);
  }
  EXPECT_GT(first.size() + taker.read_all().size(), big_bytes);
  EXPECT_EQ(router_.refusals().of(Refusal::slow), 0U);
}

} // namespace
} // namespace dyncal::inline programs::web
