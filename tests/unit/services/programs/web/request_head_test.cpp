#include "services/programs/web/request_head.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline programs::web {
namespace {

const std::string host = "Host: lab-1:8080\r\n";

int status_of(const std::string& received) {
  const auto head = read_head(received);
  return !head ? -1 : head->refusal ? head->refusal->status : 0;
}

TEST(ReadHead, KeepsTheRulesOfRfc9112) {
  struct Case {
    int status; // 0: passed on; -1: not whole
    std::string received;
  };
  const std::string ok = "GET / HTTP/1.1\r\n" + host;
  const std::string post = "POST /api/run HTTP/1.1\r\n" + host;
  const std::vector<Case> cases{
      {0, ok + "\r\n"},
      {0, "HEAD /a?b=c HTTP/1.1\r\n" + host + "\r\n"},
      {0, "OPTIONS * HTTP/1.1\r\n" + host + "\r\n"},
      {0, "GET http://lab-1/x HTTP/1.1\r\n" + host + "\r\n"},
      {0, "GET / HTTP/1.0\r\n\r\n"},
      {0, post + "Content-Length: 2\r\n\r\n{}"},
      {0, post + "Content-Length: 65536\r\nExpect: 100-Continue\r\n\r\n"},
      {0, post + "\r\n"},
      {0, ok + "Content-Encoding: identity\r\n\r\n"},
      {-1, ""},
      {-1, "GET / HTTP/1.1\r\n" + host},
      {400, "nonsense\r\n\r\n"},
      {400, "GET  / HTTP/1.1\r\n" + host + "\r\n"},
      {400, "GET / x HTTP/1.1\r\n" + host + "\r\n"},
      {400, "GET x HTTP/1.1\r\n" + host + "\r\n"},
      {400, "GET * HTTP/1.1\r\n" + host + "\r\n"},
      {400, "GET /#a HTTP/1.1\r\n" + host + "\r\n"},
      {400, "GET / HTTP/11\r\n" + host + "\r\n"},
      {400, "G(T / HTTP/1.1\r\n" + host + "\r\n"},
      {400, "GET / HTTP/1.1\r\n\r\n"},
      {400, ok + host + "\r\n"},
      {400, ok + "X : 1\r\n\r\n"},
      {400, ok + "X: 1\r\n 2\r\n\r\n"},
      {400, ok + "no colon\r\n\r\n"},
      {400, ok + "X: a\nY: b\r\n\r\n"},
      {400, ok + std::string("X: a\0b\r\n\r\n", 10)},
      {400, post + "Content-Length: -1\r\n\r\n"},
      {400, post + "Content-Length: +1\r\n\r\n"},
      {400, post + "Content-Length: \r\n\r\n"},
      {400, post + "Content-Length: 2, 2\r\n\r\n{}"},
      {400, post + "Content-Length: 2\r\nContent-Length: 3\r\n\r\n{}"},
      {400, post + "Content-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n"},
      {411, post + "Transfer-Encoding: chunked\r\n\r\n"},
      {413, post + "Content-Length: 65537\r\n\r\n"},
      {413, post + "Content-Length: 99999999999999999999999\r\n\r\n"},
      {414, "GET /" + std::string(max_line_bytes, 'a') + " HTTP/1.1\r\n" + host + "\r\n"},
      {414, "GET /" + std::string(max_line_bytes, 'a')},
      {415, post + "Content-Length: 2\r\nContent-Encoding: gzip\r\n\r\n{}"},
      {417, ok + "Expect: 200-ok\r\n\r\n"},
      {431, ok + "X: " + std::string(max_head_bytes, 'a')},
      {431, ok + "X: " + std::string(max_head_bytes, 'a') + "\r\n\r\n"},
      {501, "PRI * HTTP/1.1\r\n" + host + "\r\n"},
      {501, "get / HTTP/1.1\r\n" + host + "\r\n"},
      {501, "BREW / HTTP/1.1\r\n" + host + "\r\n"},
      {501, post + "Transfer-Encoding: gzip\r\n\r\n"},
      {505, "GET / HTTP/2.0\r\n" + host + "\r\n"},
  };
  for (const Case& one : cases) {
    EXPECT_EQ(status_of(one.received), one.status) << one.received.substr(0, 200);
  }
}

TEST(ReadHead, TakesAHundredFieldsAndNoMore) {
  std::string received = "GET / HTTP/1.1\r\n" + host;
  for (std::size_t i = 1; i < max_fields; ++i) {
    received += "X: 1\r\n";
  }
  EXPECT_EQ(status_of(received + "\r\n"), 0);
  EXPECT_EQ(status_of(received + "X: 1\r\n\r\n"), 431);
}

TEST(ReadHead, WritesARequestWithNothingToDecide) {
  const auto head = read_head("POST http://lab-1:8080?a=b HTTP/1.1\r\nhost: other\r\nX:  y \r\n"
                              "Range: bytes=0-1\r\nDyncal-Range: bytes=2-3\r\n"
                              "Expect: 100-continue\r\nCONTENT-LENGTH: 5\r\n\r\nhello");
  ASSERT_TRUE(head);
  ASSERT_FALSE(head->refusal);
  EXPECT_EQ(head->body_bytes, 5U);
  EXPECT_TRUE(head->wants_continue);
  EXPECT_EQ(head->text, "POST /?a=b HTTP/1.1\r\nHost: lab-1:8080\r\nX: y\r\n"
                        "Dyncal-Range: bytes=0-1\r\nContent-Length: 5\r\n\r\n");
}

TEST(ReadHead, EndsWhereTheEmptyLineIs) {
  const std::string first = "GET /a HTTP/1.1\r\n" + host + "\r\n";
  const auto head = read_head(first + "GET /b HTTP/1.1\r\n");
  ASSERT_TRUE(head);
  EXPECT_EQ(head->bytes, first.size());
  EXPECT_EQ(head->body_bytes, 0U);
}

} // namespace
} // namespace dyncal::inline programs::web
