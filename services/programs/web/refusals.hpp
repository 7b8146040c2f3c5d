// How many requests were refused, and why: for the log and for Prometheus. Any thread.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace dyncal::inline programs::web {

enum class Refusal {
  slow,               // it did not come within the time for a request
  too_large,          // header, address or body
  malformed,          // no request of HTTP, or a body that says nothing
  foreign_host,       // Host is another name: a page of somebody else, by DNS rebinding
  foreign_origin,     // asked for by a page of somebody else
  not_found,          // an address that is none, or leads out of the folders that are served
  too_many_listeners, // of /events
  wrong_token,
  too_many_tokens, // wrong ones lately
  not_permitted    // no token is configured
};
inline constexpr std::array refusal_names{
    "slow",      "too_large",          "malformed",   "foreign_host",    "foreign_origin",
    "not_found", "too_many_listeners", "wrong_token", "too_many_tokens", "not_permitted"};

// For labels: "foreign_host".
[[nodiscard]] constexpr const char* to_string(Refusal refusal) {
  return refusal_names.at(static_cast<std::size_t>(refusal));
}

class Refusals {
public:
  void count(Refusal refusal) { ++counts_.at(static_cast<std::size_t>(refusal)); }
  [[nodiscard]] std::uint64_t of(Refusal refusal) const {
    return counts_.at(static_cast<std::size_t>(refusal));
  }

private:
  std::array<std::atomic<std::uint64_t>, refusal_names.size()> counts_{};
};

} // namespace dyncal::inline programs::web
