#include "services/programs/web/permission.hpp"

namespace dyncal::inline programs::web {

Permission::Permission(const std::vector<TokenHolder>& tokens, bus::Clock& clock,
                       RequestRouter& router)
    : router_(router) {
  if (!tokens.empty()) {
    tokens_.emplace(tokens, clock);
  }
}

std::optional<std::string> Permission::actor_of(const httplib::Request& request,
                                                httplib::Response& response, TokenUse use) {
  if (!tokens_) {
    router_.refuse(Refusal::not_permitted, 403,
                   "this daemon takes no actions; it was started without --token-file", request,
                   response);
    return std::nullopt;
  }
  AccessTokens::Answer found = tokens_->check(request.get_header_value("Authorization"),
                                              request.remote_addr, Role::operate, use);
  if (found.answer != TokenAnswer::right) {
    refuse(found.answer, request, response);
    return std::nullopt;
  }
  return std::move(found.name);
}

bool Permission::refuses_to_show(const httplib::Request& request, httplib::Response& response) {
  // What acts is asked for more when it is known what it is.
  if (!tokens_ || !tokens_->are_needed_to_watch() || request.method == "POST") {
    return false;
  }
  const auto found =
      tokens_->check(request.get_header_value("Authorization"), request.remote_addr, Role::watch);
  if (found.answer != TokenAnswer::right) {
    refuse(found.answer, request, response);
  }
  return found.answer != TokenAnswer::right;
}

void Permission::refuse(TokenAnswer answer, const httplib::Request& request,
                        httplib::Response& response) {
  if (answer == TokenAnswer::too_many) {
    router_.refuse(Refusal::too_many_tokens, 429,
                   "too many wrong tokens from this address; try again in a minute", request,
                   response);
    response.set_header("Retry-After", "60");
  } else if (answer == TokenAnswer::not_enough) {
    router_.refuse(Refusal::not_permitted, 403, "who has this token may only watch", request,
                   response);
  } else {
    router_.refuse(Refusal::wrong_token, 401,
                   answer == TokenAnswer::none ? "a token is needed" : "the token is wrong",
                   request, response);
    // Browsers ask for name and password where nobody watches without; a page asks by itself.
    response.set_header("WWW-Authenticate", tokens_->are_needed_to_watch()
                                                ? R"(Basic realm="dyncal", charset="UTF-8")"
                                                : "Bearer");
  }
}

} // namespace dyncal::inline programs::web
