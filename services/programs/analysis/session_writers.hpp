// Which program sends the samples of a source, by its session: the one that was heard first in it.
// A restarted service has another session; two programs in one session are something else than the
// instrument (messages that are played back or made up, a machine that was copied while it ran).
// Holds the newest sessions only. One thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

#include "services/bus/writer_id.hpp"

namespace dyncal::inline programs {

class SessionWriters {
public:
  static constexpr std::size_t max_sessions = 16;

  // Whether a message of this session is of the program that was first. One
  // whose writer is not known any more, for it has ended, is taken for the first one's.
  bool takes(std::uint64_t session, const bus::WriterId& writer) {
    const auto known = std::ranges::find(sessions_, session, &Session::number);
    if (known == sessions_.end()) {
      sessions_.push_back({session, writer.participant()});
      if (sessions_.size() > max_sessions) {
        sessions_.pop_front();
      }
      return true;
    }
    const bool is_first = !writer.is_known() || known->participant.empty() ||
                          writer.participant() == known->participant;
    return is_first;
  }
  // The participant that was first in this session; empty: not known.
  [[nodiscard]] std::string first(std::uint64_t session) const {
    const auto known = std::ranges::find(sessions_, session, &Session::number);
    return known == sessions_.end() ? "" : known->participant;
  }

private:
  struct Session {
    std::uint64_t number;
    std::string participant;
  };

  std::deque<Session> sessions_;
};

} // namespace dyncal::inline programs
