// What of a source's messages a recording has, by the numbers they carry, and what the source is to
// be asked for again (idl/README.md, "Who was away").
//
// Every message is stored once, in whatever order they come: live ones, and answers to requests. A
// jump of the numbers, or a run that began before the recorder, is asked about once, again every
// 500 ms until the answer begins; a source that does not answer within `answer_limit`, or stops in
// the middle for `stall_limit`, is not waited for any longer. What is missing then counts as such.
// Of the newest `max_sessions` of a source. One object a source; one thread; no function blocks.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "services/bus/clock.hpp"

namespace dyncal::inline records::recording {

class SourceGaps {
public:
  using Instant = bus::Clock::Instant;

  static constexpr std::chrono::seconds answer_limit{10};
  static constexpr std::chrono::seconds stall_limit{5};
  static constexpr std::chrono::milliseconds request_interval{500};
  static constexpr std::size_t max_sessions = 64;

  struct Place {
    std::uint64_t session = 0;
    std::uint64_t number = 0;
    std::uint64_t first_number = 0; // of every session (contract/number_in_source.hpp)
  };
  struct Request {
    std::string name;
    std::uint64_t session = 0; // behind this message; 0: everything of the run
    std::uint64_t number = 0;
  };

  // `asker` begins the names of requests.
  explicit SourceGaps(std::string asker) : asker_(std::move(asker)) {}

  // Both return whether the message is to be stored; false: it is there already.
  bool take_live(const Place& place, Instant now);
  bool take_again(std::uint64_t session, std::uint64_t number, Instant now);
  // The empty message at the end of the answer to this request.
  void end_of_answer(const std::string& request);
  // Everything of the run that goes on is to be asked for.
  void ask_for_all(Instant now);
  [[nodiscard]] std::optional<Request> due(Instant now);
  // Something was asked for, or is to be, and is neither there nor given up.
  [[nodiscard]] bool waits() const { return active_ || !waiting_.empty(); }

  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  [[nodiscard]] std::uint64_t recovered() const { return recovered_; }
  // Numbers between two that are there, which are not; and those before, of a session that began
  // while live messages came.
  [[nodiscard]] std::uint64_t missing() const;

private:
  struct Session {
    std::map<std::uint64_t, std::uint64_t> stretches{}; // last number of each, by the first
    std::optional<std::uint64_t> begins_with{};         // where its beginning is to be there
  };
  struct Active {
    Request request;
    Instant began;
    Instant next_write;
    std::optional<Instant> heard;
  };

  [[nodiscard]] bool note(std::uint64_t session, std::uint64_t number);
  void ask(std::uint64_t session, std::uint64_t number, Instant now);

  std::string asker_;
  std::map<std::uint64_t, Session> had_;
  std::deque<std::uint64_t> sessions_;                            // of had_, oldest first
  std::optional<std::pair<std::uint64_t, std::uint64_t>> newest_; // of the live messages
  std::deque<Request> waiting_;
  std::optional<Active> active_;
  std::uint64_t requests_ = 0;
  std::uint64_t messages_ = 0;
  std::uint64_t recovered_ = 0;
};

} // namespace dyncal::inline records::recording
