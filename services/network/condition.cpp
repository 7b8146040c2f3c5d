#include "services/network/condition.hpp"

namespace dyncal::network {

const char* to_string(Severity severity) {
  switch (severity) {
  case Severity::ok:
    break;
  case Severity::note:
    return "note";
  case Severity::warning:
    return "warning";
  case Severity::error:
    return "error";
  case Severity::stale:
    return "stale";
  }
  return "ok";
}

} // namespace dyncal::network
