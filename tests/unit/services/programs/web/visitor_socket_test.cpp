// The page over TLS: what a browser gets, and those who do not speak it.
#include "services/programs/web/visitor_socket.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "services/programs/web/request_router.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/unit/services/programs/web/tls_visitor.hpp"

namespace dyncal::inline programs::web {
namespace {

constexpr std::size_t big_bytes = std::size_t{8} * 1024 * 1024; // more than the kernel holds
const std::string get_page = "GET / HTTP/1.1\r\nHost: localhost\r\n";
const std::string close_then = "Connection: close\r\n\r\n";

class VisitorSocketTest : public testing::Test {
protected:
  void SetUp() override {
    const CertificateFiles files = make_certificate(folder_.path(), "page", 7L * 86'400);
    auto certificate = TlsCertificate::read(files.certificate, files.key);
    ASSERT_TRUE(certificate) << certificate.error().message;
    router_.emplace(
        DoorOptions{.listen = {"127.0.0.1", 0}, .own_names = {}, .certificate = *certificate},
        bus::system_clock());
    router_->on_get([](const httplib::Request& request, httplib::Response& response) {
      response.set_content(std::string(big_bytes, 'a'), "text/plain");
      return request.path.starts_with("/files/");
    });
    router_->on_post([](const httplib::Request& request, httplib::Response& response) {
      response.set_content(request.body, "text/plain");
      return true;
    });
    ASSERT_TRUE(router_->start());
  }
  void expect_the_page() const {
    const TlsVisitor visitor(router_->port());
    ASSERT_TRUE(visitor.is_connected());
    ASSERT_TRUE(visitor.write(get_page + close_then));
    const std::string page = visitor.read_all();
    EXPECT_TRUE(page.starts_with("HTTP/1.1 200"));
    EXPECT_TRUE(page.ends_with("</html>\n"));
  }

  tests::TemporaryFolder folder_;
  std::optional<RequestRouter> router_;
};

TEST_F(VisitorSocketTest, ServesThePageAndNamesItsAddress) {
  EXPECT_TRUE(router_->address().starts_with("https://127.0.0.1:")) << router_->address();
  expect_the_page();
}

TEST_F(VisitorSocketTest, SendsWhatIsLongerThanTheKernelHolds) {
  const TlsVisitor visitor(router_->port());
  ASSERT_TRUE(visitor.write("GET /files/a/b/c HTTP/1.1\r\nHost: localhost\r\n" + close_then));
  const std::string answer = visitor.read_all();
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 200"));
  const auto body = answer.find("\r\n\r\n");
  ASSERT_NE(body, std::string::npos);
  EXPECT_EQ(answer.substr(body + 4), std::string(big_bytes, 'a'));
}

// OpenSSL writes without MSG_NOSIGNAL: a signal would end the process.
TEST_F(VisitorSocketTest, OutlivesAVisitorWhoGoesWhileMuchIsSent) {
  for (int i = 0; i < 10; ++i) {
    const TlsVisitor visitor(router_->port());
    ASSERT_TRUE(visitor.write("GET /files/a/b/c HTTP/1.1\r\nHost: localhost\r\n" + close_then));
    EXPECT_FALSE(visitor.read().empty());
  }
  expect_the_page();
}

TEST_F(VisitorSocketTest, AnswersOneRequestAfterTheOtherOfAConnection) {
  const TlsVisitor visitor(router_->port());
  const std::string post = "POST /api/run HTTP/1.1\r\nHost: localhost\r\n"
                           "Content-Type: application/json\r\nContent-Length: 5\r\n";
  ASSERT_TRUE(visitor.write(post + "\r\nfirst" + post + close_then + "other"));
  const std::string answers = visitor.read_all();
  const auto first = answers.find("first");
  ASSERT_NE(first, std::string::npos) << answers;
  EXPECT_NE(answers.find("other", first), std::string::npos) << answers;
}

TEST_F(VisitorSocketTest, TellsWhoSpeaksPlainHttp) {
  const RawVisitor visitor(router_->port());
  ASSERT_TRUE(visitor.write(get_page + close_then));
  EXPECT_NE(visitor.read_all().find("https://"), std::string::npos);
}

// Nobody who says nothing, or garbage, holds up who shakes hands; and he is let go.
TEST_F(VisitorSocketTest, WaitsForNobodyWhoDoesNotShakeHands) {
  std::vector<RawVisitor> silent;
  for (int i = 0; i < 400; ++i) {
    silent.emplace_back(router_->port());
    ASSERT_TRUE(i % 2 == 0 || silent.back().write(std::string(64, '\x16')));
  }
  expect_the_page();
  for (const RawVisitor& visitor : silent) {
    EXPECT_EQ(visitor.read_all().find("200"), std::string::npos);
  }
  expect_the_page();
}

} // namespace
} // namespace dyncal::inline programs::web
