// The router open to visitors: a real server on a free port of loopback, and visitors with bad
// manners.
#include "services/programs/web/request_router.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/bus/memory/memory_network.hpp"
#include "services/programs/web/actions.hpp"
#include "services/programs/web/event_stream.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/network/messages.hpp"

namespace dyncal::inline programs::web {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr const char* secret = "0123456789abcdef0123";

class RequestRouterTest : public testing::Test {
protected:
  void SetUp() override {
    router_.on_get(
        [this](const auto& request, auto& response) { return answers_.answer(request, response); });
    router_.on_get(
        [this](const auto& request, auto& response) { return events_.answer(request, response); });
    router_.on_post(
        [this](const auto& request, auto& response) { return actions_.post(request, response); });
    cache_.change([](network::BusState& laboratory) {
      laboratory.take(network::status_of("<b>acc-1</b>", "dau"));
    });
    ASSERT_TRUE(router_.start());
  }
  [[nodiscard]] httplib::Client visitor() const {
    httplib::Client client("127.0.0.1", router_.port());
    client.set_read_timeout(20s);
    return client;
  }
  [[nodiscard]] std::uint64_t refused(Refusal refusal) const {
    return router_.refusals().of(refusal);
  }
  // What a visitor is answered who writes these bytes and then nothing.
  [[nodiscard]] std::string answer_to(const std::string& bytes) const {
    const int visitor = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(router_.port()));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval limit{.tv_sec = 20, .tv_usec = 0};
    setsockopt(visitor, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
    EXPECT_EQ(connect(visitor, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(send(visitor, bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
    std::string answer(4096, '\0');
    const ssize_t count = recv(visitor, answer.data(), answer.size(), 0);
    close(visitor);
    answer.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return answer;
  }
  httplib::Result command(const std::string& token, const httplib::Headers& more = {},
                          const std::string& body = "{}") {
    httplib::Headers headers = more;
    headers.emplace("Authorization", "Bearer " + token);
    return visitor().Post("/api/bench/acc-1/command", headers, body, "application/json");
  }

  tests::TemporaryFolder folder_;
  bus::MemoryNetwork network_;
  bus::Participant participant_ = network_.join("web");
  bus::Clock& clock_ = bus::system_clock();
  StateCache cache_{clock_, [](Json&) {}};
  RunFiles files_{folder_.path()};
  RequestRouter router_{{.listen = {"127.0.0.1", 0},
                         .own_names = {"lab-1"},
                         .javascript_folder = folder_.path(),
                         .guide_folder = ""},
                        clock_};
  LaboratoryAnswers answers_{cache_, files_};
  EventStream events_{cache_, answers_, router_,
                      [](const std::string&, const httplib::Request&) { return Text(); }};
  Permission permission_{{{.token = secret}}, clock_, router_};
  Actions actions_{{.benches_folder = {},
                    .runs_folder = {},
                    .network = {},
                    .run_security = {},
                    .sender = "test"},
                   participant_,
                   clock_,
                   cache_,
                   router_,
                   permission_};
};

TEST_F(RequestRouterTest, ServesThePageWithHeadersThatAllowNothingForeign) {
  const auto page = visitor().Get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_NE(page->body.find("<html"), std::string::npos);
  EXPECT_EQ(page->get_header_value("X-Content-Type-Options"), "nosniff");
  EXPECT_NE(page->get_header_value("Content-Security-Policy").find("default-src 'self'"),
            std::string::npos);
  EXPECT_EQ(visitor().Get("/page/index.html")->status, 200);
  EXPECT_EQ(visitor().Get("/page/other.html")->status, 404);
}

TEST_F(RequestRouterTest, AnswersWithHostileNamesAsText) {
  const auto answer = visitor().Get("/api/bench/%3Cb%3Eacc-1%3C%2Fb%3E");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
  EXPECT_EQ(answer->get_header_value("Content-Type"), "application/json");
  EXPECT_EQ(Json::parse(answer->body)["bench"], "<b>acc-1</b>");
}

TEST_F(RequestRouterTest, SharesItsPortWithNobody) {
  RequestRouter second{{.listen = {"127.0.0.1", static_cast<std::uint16_t>(router_.port())},
                        .own_names = {},
                        .javascript_folder = folder_.path(),
                        .guide_folder = ""},
                       clock_};
  const auto started = second.start();
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().code, ErrorCode::network);
  EXPECT_NE(started.error().message.find("Address already in use"), std::string::npos)
      << started.error().message;
}

TEST_F(RequestRouterTest, ClosesAsSoonAsItHasOpened) {
  for (int i = 0; i < 200; ++i) {
    RequestRouter other{{.listen = {"127.0.0.1", 0},
                         .own_names = {},
                         .javascript_folder = folder_.path(),
                         .guide_folder = ""},
                        clock_};
    ASSERT_TRUE(other.start());
    ASSERT_GT(other.port(), 0);
    other.stop();
  }
}

TEST_F(RequestRouterTest, LeadsOutOfNoFolder) {
  std::ofstream(folder_.path() / "library.js") << "1";
  EXPECT_EQ(visitor().Get("/javascript/library.js")->status, 200);
  for (const char* path :
       {"/javascript/../../../etc/passwd", "/javascript/%2e%2e/%2e%2e/etc/passwd",
        "/page/../page_files.hpp", "/files/../../etc/passwd", "/files/acc-1/..%2f..%2f/etc/passwd",
        "/javascript/..%5c..%5cetc/passwd", "/javascript//etc/passwd", "/page/%00index.html",
        "//etc/passwd", "/api/bench/../../etc/passwd"}) {
    const std::string answer =
        answer_to(std::string("GET ") + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_NE(answer.find(" 404 "), std::string::npos) << path << ": " << answer;
    EXPECT_EQ(answer.find("root:"), std::string::npos) << path;
  }
  EXPECT_GE(refused(Refusal::not_found), 6U);
}

TEST_F(RequestRouterTest, AnswersNobodyWhoCallsItByAnotherName) {
  EXPECT_EQ(visitor().Get("/api/laboratory", {{"Host", "evil.example"}})->status, 421);
  EXPECT_EQ(visitor().Get("/api/laboratory", {{"Host", "lab-1:8080"}})->status, 200);
  EXPECT_EQ(refused(Refusal::foreign_host), 1U);
  EXPECT_EQ(visitor().Get("/api/laboratory", {{"Origin", "http://evil.example"}})->status, 403);
  EXPECT_EQ(command(secret, {{"Origin", "http://evil.example"}})->status, 403);
  EXPECT_EQ(refused(Refusal::foreign_origin), 2U);
}

TEST_F(RequestRouterTest, RefusesWhatIsTooLargeOrNoRequest) {
  EXPECT_EQ(command(secret, {}, std::string(max_body_bytes + 1, ' '))->status, 413);
  EXPECT_EQ(visitor().Get("/" + std::string(2000, 'a'))->status, 414);
  EXPECT_GE(refused(Refusal::too_large), 2U);
  EXPECT_NE(answer_to("nonsense\r\n\r\n").find(" 400 "), std::string::npos);
  EXPECT_EQ(visitor().Delete("/api/laboratory")->status, 405);
  EXPECT_EQ(visitor().Post("/api/run", "{}", "text/plain")->status, 415);
}

TEST_F(RequestRouterTest, EndsARequestThatDoesNotCome) {
  const auto began = Clock::now();
  std::vector<std::thread> visitors;
  visitors.reserve(10);
  for (int i = 0; i < 10; ++i) {
    visitors.emplace_back([this] { (void)answer_to("GET / HTTP/1.1\r\nHost: localhost\r\nX: "); });
  }
  EXPECT_EQ(visitor().Get("/")->status, 200) << "meanwhile others are answered";
  for (std::thread& one : visitors) {
    one.join();
  }
  EXPECT_GE(Clock::now() - began, LimitedServer::request_limit - 100ms);
  EXPECT_LT(Clock::now() - began, LimitedServer::request_limit + 10s);
  EXPECT_EQ(refused(Refusal::slow), 10U);
}

TEST_F(RequestRouterTest, TakesActionsWithTheTokenOnly) {
  EXPECT_EQ(command("wrong")->status, 401);
  EXPECT_EQ(visitor().Post("/api/bench/acc-1/command", "{}", "application/json")->status, 401)
      << "none at all, which is no guess";
  EXPECT_EQ(command(secret)->status, 400) << "the body says nothing";
  const auto nobody = command(secret, {}, R"({"command": "abort", "run": "r1"})");
  EXPECT_EQ(nobody->status, 409);
  EXPECT_EQ(Json::parse(nobody->body)["answer"], "refused");
  for (std::size_t i = 1; i < AccessTokens::max_wrong; ++i) {
    EXPECT_EQ(command("wrong")->status, 401) << i;
  }
  const auto many = command(secret, {}, R"({"command": "pause", "run": "r1"})");
  EXPECT_EQ(many->status, 429);
  EXPECT_EQ(command(secret, {}, R"({"command": "abort", "run": "r1"})")->status, 409)
      << "the emergency stop is never locked";
  EXPECT_EQ(command("wrong", {}, R"({"command": "abort", "run": "r1"})")->status, 429);
  EXPECT_EQ(many->get_header_value("Retry-After"), "60");
  EXPECT_EQ(refused(Refusal::wrong_token), 6U);
}

TEST_F(RequestRouterTest, LetsAsManyListenAsItHasRoomFor) {
  constexpr int count = 100;
  std::atomic<int> heard = 0;
  std::atomic<int> full = 0;
  const auto end = Clock::now() + 30s;
  std::vector<std::thread> visitors;
  visitors.reserve(count);
  for (int i = 0; i < count; ++i) {
    visitors.emplace_back([&] {
      httplib::Client client = visitor();
      const auto answer = client.Get("/events", [&](const char* data, std::size_t size) {
        const bool is_state = std::string_view(data, size).find("laboratory") != std::string::npos;
        if (is_state) {
          ++heard;
        }
        // The listeners stay until all others have been refused.
        return !is_state || (full < count - EventStream::max_listeners && Clock::now() < end);
      });
      full += answer && answer->status == 503 ? 1 : 0;
    });
  }
  for (std::thread& one : visitors) {
    one.join();
  }
  EXPECT_GE(heard, EventStream::max_listeners);
  EXPECT_EQ(full, count - EventStream::max_listeners);
  EXPECT_EQ(refused(Refusal::too_many_listeners),
            static_cast<std::uint64_t>(count - EventStream::max_listeners));
  EXPECT_EQ(visitor().Get("/")->status, 200);
  EXPECT_LT(Clock::now(), end) << "some had to knock again and again";
}

} // namespace
} // namespace dyncal::inline programs::web
