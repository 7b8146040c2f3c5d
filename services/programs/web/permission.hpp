// Who may watch, and who may act: holds each request against the tokens, and answers those that it
// refuses. Any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <httplib.h>

#include "services/programs/web/access_tokens.hpp"
#include "services/programs/web/request_router.hpp"

namespace dyncal::inline programs::web {

class Permission {
public:
  // No tokens: everybody watches, nobody acts. `clock` and `router` outlive the object.
  Permission(const std::vector<TokenHolder>& tokens, bus::Clock& clock, RequestRouter& router);

  [[nodiscard]] bool may_act() const { return tokens_.has_value(); }
  // The name of who acts, which may be empty; nothing: he may not, and is answered.
  [[nodiscard]] std::optional<std::string> actor_of(const httplib::Request& request,
                                                    httplib::Response& response,
                                                    TokenUse use = TokenUse::ordinary);
  // True: he may not, and is answered.
  [[nodiscard]] bool refuses_to_show(const httplib::Request& request, httplib::Response& response);

private:
  void refuse(TokenAnswer answer, const httplib::Request& request, httplib::Response& response);

  std::optional<AccessTokens> tokens_;
  RequestRouter& router_;
};

} // namespace dyncal::inline programs::web
