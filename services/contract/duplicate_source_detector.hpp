// Notices two services that send as one source: their sessions take turns.
//
// A service that restarts changes the session once and never back; blocks of the session that it
// left may still come late, once. What has come alone for long is no twin any more, where that is
// wanted: statuses come from each service once a second, blocks of a run in bursts of any length.
// Plain data, one thread.
#pragma once

#include <cstdint>
#include <optional>

namespace dyncal::inline contract {

class DuplicateSourceDetector {
public:
  static constexpr int min_returns = 2;

  DuplicateSourceDetector() = default; // never forgets
  // Forgets the other session when one has come `alone` times in a row.
  explicit DuplicateSourceDetector(int alone) : alone_(alone) {}

  // The session of a message of the source, in the order of reception.
  void add(std::uint64_t session);
  [[nodiscard]] bool twins() const { return returns_ >= min_returns; }

private:
  int alone_ = 0;
  int in_a_row_ = 0; // of session_
  std::optional<std::uint64_t> session_;
  std::optional<std::uint64_t> left_; // the session before
  int returns_ = 0;                   // to a session that had been left
};

} // namespace dyncal::inline contract
