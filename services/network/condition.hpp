// How well something is, and the reason in one sentence; and what happened when. Plain data and
// functions; any thread.
#pragma once

#include <cstdint>
#include <string>

#include "services/base/finding.hpp"

namespace dyncal::network {

struct Condition {
  Severity severity = Severity::ok;
  std::string what; // empty: nothing is wrong

  // Takes the other one if it is worse.
  void raise_severity(Severity other, std::string reason) {
    if (other > severity) {
      severity = other;
      what = std::move(reason);
    }
  }
};

struct Event {
  std::int64_t utc_ns = 0;
  std::string bench;
  Severity severity = Severity::note;
  std::string text;
};

} // namespace dyncal::network
