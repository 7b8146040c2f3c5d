#include "services/programs/web/refusals.hpp"

namespace dyncal::inline programs::web {

const char* to_string(Refusal refusal) {
  switch (refusal) {
  case Refusal::slow:
    return "slow";
  case Refusal::too_large:
    return "too_large";
  case Refusal::malformed:
    return "malformed";
  case Refusal::foreign_host:
    return "foreign_host";
  case Refusal::foreign_origin:
    return "foreign_origin";
  case Refusal::not_found:
    return "not_found";
  case Refusal::too_many_listeners:
    return "too_many_listeners";
  case Refusal::wrong_token:
    return "wrong_token";
  case Refusal::too_many_tokens:
    return "too_many_tokens";
  case Refusal::not_permitted:
    break;
  }
  return "not_permitted";
}

} // namespace dyncal::inline programs::web
