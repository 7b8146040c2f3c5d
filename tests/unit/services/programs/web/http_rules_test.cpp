// The rules of RFC 9110 and 9112 as they hold on the wire.
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "services/programs/web/laboratory_answers.hpp"
#include "services/programs/web/request_router.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/network/messages.hpp"
#include "tests/unit/services/programs/web/raw_visitor.hpp"

namespace dyncal::inline programs::web {
namespace {

namespace fs = std::filesystem;

constexpr const char* run_file = "/files/acc-1/r1/result.json";

class HttpRules : public testing::Test {
protected:
  void SetUp() override {
    const fs::path run = folder_.path() / "acc-1" / "20261122T101530.125Z-r1";
    fs::create_directories(run);
    std::ofstream(run / "result.json") << "0123456789";
    std::ofstream(run / "empty.txt");
    std::ofstream(folder_.path() / "library.js") << "1";
    fs::create_symlink("/etc/passwd", folder_.path() / "link.js");
    router_.on_get(
        [this](const auto& request, auto& response) { return answers_.answer(request, response); });
    router_.on_post([](const httplib::Request& request, httplib::Response& response) {
      response.set_content(request.body, "text/plain");
      return request.path == "/api/run";
    });
    cache_.change(
        [](network::BusState& laboratory) { laboratory.take(network::status_of("acc-1", "dau")); });
    ASSERT_TRUE(router_.start());
  }
  // Head and body of the answer to these lines, after which the connection is closed.
  [[nodiscard]] std::string answer_to(const std::string& lines,
                                      const std::string& body = "") const {
    const RawVisitor visitor(router_.port());
    EXPECT_TRUE(visitor.write(lines + "Connection: close\r\n\r\n" + body));
    return visitor.read_all();
  }
  [[nodiscard]] std::string get(const std::string& path, const std::string& fields = "",
                                const std::string& method = "GET") const {
    return answer_to(method + " " + path + " HTTP/1.1\r\nHost: localhost\r\n" + fields);
  }
  static std::string status_of(const std::string& answer) {
    return answer.starts_with("HTTP/1.1 ") ? answer.substr(9, 3) : "none";
  }
  // Empty: the field is not there.
  static std::string field_of(const std::string& answer, const std::string& name) {
    const auto begin = answer.find("\r\n" + name + ": ");
    if (begin == std::string::npos) {
      return "";
    }
    const auto value = begin + name.size() + 4;
    return answer.substr(value, answer.find("\r\n", value) - value);
  }
  static std::string body_of(const std::string& answer) {
    const auto end = answer.find("\r\n\r\n");
    return end == std::string::npos ? "" : answer.substr(end + 4);
  }

  tests::TemporaryFolder folder_;
  bus::Clock& clock_ = bus::system_clock();
  StateCache cache_{clock_, [](nlohmann::ordered_json&) {}};
  RunFiles files_{folder_.path()};
  LaboratoryAnswers answers_{cache_, files_};
  RequestRouter router_{{.listen = {"127.0.0.1", 0},
                         .own_names = {},
                         .javascript_folder = folder_.path(),
                         .guide_folder = ""},
                        clock_};
};

TEST_F(HttpRules, AnswerEveryMethodAtEveryKindOfAddress) {
  struct Case {
    const char* method;
    const char* path;
    const char* status;
    const char* allow;
  };
  constexpr const char* read = "GET, HEAD, OPTIONS";
  constexpr const char* act = "POST, OPTIONS";
  const Case cases[] = {
      {"GET", "/", "200", ""},
      {"HEAD", "/", "200", ""},
      {"OPTIONS", "/", "200", read},
      {"OPTIONS", "*", "200", "GET, HEAD, POST, OPTIONS"},
      {"OPTIONS", "/api/run", "200", act},
      {"OPTIONS", "/nothing", "404", ""},
      {"POST", "/", "405", read},
      {"PUT", "/api/laboratory", "405", read},
      {"DELETE", run_file, "405", read},
      {"PATCH", "/api/run", "405", act},
      {"TRACE", "/", "405", read},
      {"GET", "/api/run", "405", act},
      {"HEAD", "/api/bench/acc-1/command", "405", act},
      {"GET", "/nothing", "404", ""},
      {"POST", "/nothing", "404", ""},
      {"DELETE", "/nothing", "404", ""},
      {"BREW", "/", "501", ""},
      {"CONNECT", "localhost:80", "501", ""},
      {"GET", "/javascript/library.js", "200", ""},
      {"GET", "/javascript/link.js", "404", ""},
      {"GET", "/javascript/", "404", ""},
  };
  for (const Case& one : cases) {
    const std::string answer = get(one.path, "", one.method);
    EXPECT_EQ(status_of(answer), one.status) << one.method << " " << one.path;
    EXPECT_EQ(field_of(answer, "Allow"), one.allow) << one.method << " " << one.path;
    EXPECT_EQ(answer.find("root:"), std::string::npos);
  }
}

TEST_F(HttpRules, HeadTellsWhatGetWouldSendAndSendsNothing) {
  for (const char* path : {"/page/index.html", "/api/bench/acc-1", run_file, "/nothing"}) {
    const std::string whole = get(path);
    const std::string head = get(path, "", "HEAD");
    EXPECT_EQ(status_of(head), status_of(whole)) << path;
    EXPECT_EQ(field_of(head, "Content-Length"), std::to_string(body_of(whole).size())) << path;
    EXPECT_EQ(field_of(head, "Content-Type"), field_of(whole, "Content-Type")) << path;
    EXPECT_FALSE(body_of(whole).empty()) << path;
    EXPECT_EQ(body_of(head), "") << path;
  }
}

TEST_F(HttpRules, RefuseWhatIsNoRequestWithItsStatus) {
  const std::string host = "Host: localhost\r\n";
  const std::string json = host + "Content-Type: application/json\r\n";
  const std::pair<std::string, const char*> cases[] = {
      {"nonsense\r\n", "400"},
      {"GET / HTTP/1.1\r\n", "400"},
      {"GET / HTTP/1.1\r\n" + host + host, "400"},
      {"GET / HTTP/1.1\r\nHost: evil.example\r\n", "421"},
      {"GET http://evil.example/ HTTP/1.1\r\n" + host, "421"},
      {"GET http://localhost/ HTTP/1.1\r\nHost: evil.example\r\n", "200"},
      {"\r\nGET / HTTP/1.1\r\n" + host, "200"},
      {"GET / HTTP/2.0\r\n" + host, "505"},
      {"GET /" + std::string(2000, 'a') + " HTTP/1.1\r\n" + host, "414"},
      {"GET / HTTP/1.1\r\n" + host + "X: " + std::string(20000, 'a') + "\r\n", "431"},
      {"GET / HTTP/1.1\r\n" + host + "X: " + std::string(4000, 'a') + "\r\n", "200"},
      {"POST /api/run HTTP/1.1\r\n" + json + "Content-Length: -1\r\n", "400"},
      {"POST /api/run HTTP/1.1\r\n" + json + "Transfer-Encoding: chunked\r\n", "411"},
      {"POST /api/run HTTP/1.1\r\n" + json + "Content-Length: 70000\r\n", "413"},
      {"POST /api/run HTTP/1.1\r\n" + json, "200"},
      {"POST /api/run HTTP/1.1\r\n" + host + "Content-Type: application/jsonp\r\n", "415"},
      {"POST /api/run HTTP/1.1\r\n" + host + "Content-Type: Application/JSON; charset=utf-8\r\n",
       "200"},
  };
  for (const auto& [lines, status] : cases) {
    const std::string answer = answer_to(lines);
    EXPECT_EQ(status_of(answer), status) << lines.substr(0, 100);
    if (*status == '4' || *status == '5') {
      EXPECT_TRUE(nlohmann::json::parse(body_of(answer))["error"]["message"].is_string());
    }
  }
  EXPECT_GE(router_.refusals().of(Refusal::malformed), 6U);
  EXPECT_GE(router_.refusals().of(Refusal::too_large), 3U);
}

TEST_F(HttpRules, TakeABodyThatWaitsForItsContinue) {
  const RawVisitor visitor(router_.port());
  ASSERT_TRUE(visitor.write("POST /api/run HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n"
                            "Content-Type: application/json\r\nConnection: close\r\n"
                            "Expect: 100-continue\r\n\r\n"));
  EXPECT_EQ(visitor.read(), "HTTP/1.1 100 Continue\r\n\r\n");
  ASSERT_TRUE(visitor.write("hello"));
  const std::string answer = visitor.read_all(); // head and body may come one after the other
  EXPECT_EQ(status_of(answer), "200");
  EXPECT_EQ(body_of(answer), "hello");
}

TEST_F(HttpRules, AnswerRequestsThatComeTogetherInTheirOrder) {
  const RawVisitor visitor(router_.port());
  const std::string fields = " HTTP/1.1\r\nHost: localhost\r\n";
  ASSERT_TRUE(visitor.write("HEAD /" + fields + "\r\nHEAD /nothing" + fields + "\r\nHEAD /api/run" +
                            fields + "Connection: close\r\n\r\n"));
  const std::string answers = visitor.read_all();
  const auto first = answers.find("HTTP/1.1 200");
  const auto second = answers.find("HTTP/1.1 404");
  const auto third = answers.find("HTTP/1.1 405");
  EXPECT_EQ(first, 0U) << answers;
  ASSERT_NE(second, std::string::npos);
  ASSERT_NE(third, std::string::npos);
  EXPECT_LT(second, third);
}

// What a body says is no request, even where the method has none.
TEST_F(HttpRules, ReadNoRequestInTheBodyOfAnother) {
  const RawVisitor visitor(router_.port());
  const std::string inner = "GET /api/laboratory HTTP/1.1\r\nHost: localhost\r\n\r\n";
  ASSERT_TRUE(visitor.write("HEAD / HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
                            std::to_string(inner.size()) + "\r\n\r\n" + inner));
  const std::string answers = visitor.read_all(); // until the connection has been idle
  EXPECT_EQ(status_of(answers), "200");
  EXPECT_EQ(answers.find("HTTP/1.1", 1), std::string::npos) << answers;
}

TEST_F(HttpRules, GiveRangesOfFiles) {
  struct Case {
    const char* fields;
    const char* status;
    const char* range;
    const char* body;
  };
  const Case cases[] = {
      {"", "200", "", "0123456789"},
      {"Range: bytes=2-4\r\n", "206", "bytes 2-4/10", "234"},
      {"Range: bytes=-2\r\n", "206", "bytes 8-9/10", "89"},
      {"Range: bytes=7-\r\n", "206", "bytes 7-9/10", "789"},
      {"Range: bytes=0-1,3-4\r\n", "200", "", "0123456789"},
      {"Range: bytes=4-2\r\n", "200", "", "0123456789"},
      {"Range: lines=1\r\n", "200", "", "0123456789"},
      {"Range: bytes=2-4\r\nIf-Range: \"other\"\r\n", "200", "", "0123456789"},
  };
  for (const Case& one : cases) {
    const std::string answer = get(run_file, one.fields);
    EXPECT_EQ(status_of(answer), one.status) << one.fields;
    EXPECT_EQ(field_of(answer, "Content-Range"), one.range) << one.fields;
    EXPECT_EQ(body_of(answer), one.body) << one.fields;
    EXPECT_EQ(field_of(answer, "Content-Length"), std::to_string(body_of(answer).size()));
  }
  const std::string beyond = get(run_file, "Range: bytes=10-\r\n");
  EXPECT_EQ(status_of(beyond), "416");
  EXPECT_EQ(field_of(beyond, "Content-Range"), "bytes */10");
  const std::string empty = get("/files/acc-1/r1/empty.txt");
  EXPECT_EQ(status_of(empty), "200");
  EXPECT_EQ(field_of(empty, "Content-Length"), "0");
  const std::string error = get("/nothing", "Range: bytes=0-1\r\n");
  EXPECT_EQ(status_of(error), "404") << "errors have no ranges";
  EXPECT_EQ(field_of(error, "Content-Range"), "");
}

TEST_F(HttpRules, SendNothingToWhomHasItAlready) {
  const std::string tag = field_of(get(run_file), "ETag");
  ASSERT_FALSE(tag.empty());
  const std::string same = get(run_file, "If-None-Match: " + tag + "\r\n");
  EXPECT_EQ(status_of(same), "304");
  EXPECT_EQ(body_of(same), "");
  EXPECT_EQ(field_of(same, "ETag"), tag);
  EXPECT_EQ(status_of(get(run_file, "If-None-Match: \"other\"\r\n")), "200");
  EXPECT_EQ(status_of(get(run_file, "If-Range: " + tag + "\r\nRange: bytes=0-0\r\n")), "206");
}

} // namespace
} // namespace dyncal::inline programs::web
