// The messages of one source of a run in order, without a break where the source can still close
// it: live ones, and those that were asked for again (idl/README.md, "Who was away").
//
// Messages of a source count from its answer on: the one that names the run. From then on every one
// is handed over once and in order. At a jump of the numbers, and when nothing has come for
// `silence_limit`, the follower asks for what the source has sent behind the last message that was
// handed over, and holds the live ones until that has come. What the answer does not have either is
// lost for good; the evaluation counts it. A follower that begins in the middle of a run asks for
// everything from the source's answer on.
//
// Held are at most `max_held_bytes`. What is beyond is thrown away and asked for again. A source
// that does not answer at all, although it sends, is followed as it is after `answer_limit`.
//
// Message: wire::SampleBlock, or wire::TriggeredRecord, whose empty messages have no number.
// Belongs to the run's one thread; no function blocks.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <set>
#include <string>

#include "idl/dyncal.h"
#include "services/bus/clock.hpp"

namespace dyncal::inline programs {

// That a block takes in memory.
[[nodiscard]] std::size_t bytes_of(const wire::SampleBlock& block);

// A message within its source: block, or shot.
struct StreamPosition {
  std::uint64_t session = 0; // 0: before the first
  std::uint64_t number = 0;
  bool operator==(const StreamPosition&) const = default;
};

struct CatchUp {
  std::string request; // its name
  StreamPosition behind;
};

template <class Message>
class StreamFollower {
public:
  using Instant = bus::Clock::Instant;
  using HandOver = std::function<void(const Message&)>;

  static constexpr std::chrono::seconds silence_limit{2};
  // On a link that the live messages nearly fill, the two ends of an answer take long to match.
  static constexpr std::chrono::seconds answer_limit{30};
  static constexpr std::chrono::seconds stall_limit{5}; // between two messages of an answer
  static constexpr std::chrono::milliseconds request_interval{500};
  static constexpr std::size_t max_held_bytes = std::size_t{64} << 20U;

  // `asker` begins the names of requests.
  StreamFollower(std::string run, std::string asker, HandOver hand_over)
      : run_(std::move(run)), asker_(std::move(asker)), hand_over_(std::move(hand_over)) {}

  // The run began before: everything from the source's answer on is to be asked for.
  void start_by_catching_up(Instant now) {
    awaits_beginning_ = true;
    begin_catch_up(now);
  }
  // False: it had come before, and is left out.
  bool take_live(const Message& message, Instant now);
  void take_again(const Message& message, Instant now);
  // What has to be asked for now, again and again while nothing comes.
  [[nodiscard]] std::optional<CatchUp> due(Instant now);

  [[nodiscard]] bool answered() const { return answered_; }
  // Begun in the middle of a run, and the source does not have what it sent from its answer on.
  [[nodiscard]] bool lacks_beginning() const { return lacks_beginning_; }
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] bool catching_up() const { return request_.has_value(); }
  // Nothing that was not known came for `silence_limit`, although blocks come all the time: an
  // answer without any does not end that.
  [[nodiscard]] bool silent(Instant now) const;
  // When a message came last that was not known.
  [[nodiscard]] Instant heard() const { return heard_; }
  // Messages that had to be asked for again and came.
  [[nodiscard]] std::uint64_t recovered() const { return recovered_; }

private:
  struct Request {
    std::string name;
    std::optional<StreamPosition> behind;
    Instant began;
    Instant next_write;
    std::optional<Instant> heard; // the newest message of the answer
  };

  [[nodiscard]] bool is_known(const Message& message) const;
  [[nodiscard]] bool follows(const Message& message) const;
  void accept(const Message& message);
  void hold(const Message& message);
  void begin_catch_up(Instant now);
  void end_catch_up(Instant now);

  std::string run_;
  std::string asker_;
  HandOver hand_over_;
  bool awaits_beginning_ = false;
  bool lacks_beginning_ = false;
  bool answered_ = false;
  bool ended_ = false;
  std::optional<StreamPosition> newest_; // that was handed over
  std::set<std::uint64_t> left_;         // sessions before that one
  Instant heard_{};
  Instant asked_{}; // when the last answer had come
  std::optional<Request> request_;
  // Where the last answer that came to its end began: nothing behind it can be had any more.
  std::optional<StreamPosition> answered_behind_;
  std::uint64_t requests_ = 0;
  std::uint64_t recovered_ = 0;
  std::deque<Message> held_;
  std::size_t held_bytes_ = 0;
};

} // namespace dyncal::inline programs
