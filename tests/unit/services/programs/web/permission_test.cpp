#include "services/programs/web/permission.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline programs::web {
namespace {

constexpr const char* of_ada = "0123456789abcdef0123";
constexpr const char* of_screen = "fedcba98765432100000";

class PermissionTest : public testing::Test {
protected:
  // A server of these tokens whose only action answers with the name of who acts.
  void serve(const std::vector<TokenHolder>& tokens) {
    router_.emplace(DoorOptions{.listen = {"127.0.0.1", 0}, .own_names = {}}, bus::system_clock());
    permission_.emplace(tokens, bus::system_clock(), *router_);
    router_->on_request([this](const auto& request, auto& response) {
      return permission_->refuses_to_show(request, response);
    });
    router_->on_post([this](const auto& request, auto& response) {
      if (const auto actor = permission_->actor_of(request, response)) {
        response.set_content("by " + *actor, "text/plain");
      }
      return true;
    });
    ASSERT_TRUE(router_->start());
  }
  [[nodiscard]] httplib::Client visitor(const std::string& token = "") const {
    httplib::Client client("127.0.0.1", router_->port());
    if (!token.empty()) {
      client.set_bearer_token_auth(token);
    }
    return client;
  }
  [[nodiscard]] int watches(httplib::Client client) const { return client.Get("/")->status; }
  [[nodiscard]] httplib::Result acts(httplib::Client client) const {
    return client.Post("/api/run", "{}", "application/json");
  }

  std::optional<RequestRouter> router_;
  std::optional<Permission> permission_;
};

TEST_F(PermissionTest, EverybodyWatchesWhereNobodyNeedsToken) {
  serve({{Role::operate, "ada", of_ada}});
  EXPECT_EQ(watches(visitor()), 200);
  EXPECT_EQ(acts(visitor())->status, 401);
  EXPECT_EQ(acts(visitor())->get_header_value("WWW-Authenticate"), "Bearer");
  EXPECT_EQ(acts(visitor(of_ada))->body, "by ada");
}

TEST_F(PermissionTest, NobodyActsWithoutTokens) {
  serve({});
  EXPECT_EQ(watches(visitor()), 200);
  EXPECT_EQ(acts(visitor(of_ada))->status, 403);
}

TEST_F(PermissionTest, NobodyWatchesWithoutATokenWhereSomebodyMayOnlyWatch) {
  serve({{Role::operate, "ada", of_ada}, {Role::watch, "screen", of_screen}});
  for (const char* path : {"/", "/page/style.css", "/api/laboratory", "/events", "/files/a/b/c"}) {
    const auto refused = visitor().Get(path);
    EXPECT_EQ(refused->status, 401) << path;
    EXPECT_TRUE(refused->get_header_value("WWW-Authenticate").starts_with("Basic ")) << path;
  }
  EXPECT_EQ(watches(visitor(of_screen)), 200);
  EXPECT_EQ(acts(visitor(of_screen))->status, 403);
  EXPECT_EQ(watches(visitor(of_ada)), 200);
  EXPECT_EQ(acts(visitor(of_ada))->body, "by ada");
  httplib::Client browser = visitor();
  browser.set_basic_auth("screen", of_screen);
  EXPECT_EQ(browser.Get("/")->status, 200);
  browser.set_basic_auth("ada", of_screen);
  EXPECT_EQ(browser.Get("/")->status, 401);
  EXPECT_EQ(router_->refusals().of(Refusal::wrong_token), 6U);
}

} // namespace
} // namespace dyncal::inline programs::web
