// Whose word counts about the exciter of a bench: that of one conductor, until its run is over or
// it is not heard any more and the output is known to be off.
//
// A message is of the conductor when it comes from the participant that began with the run, and
// shows a link of the run's chain (services/contract/one_way_chain.hpp) that was not shown before.
// So neither a repeated nor an invented message counts, and what the link does not cover, the words
// themselves, cannot come from another program that has just seen the link. Each topic has a chain,
// for topics have no order among each other. What others say is passed over, also that the run is
// over: it must neither hold a driven output on nor switch it off.
//
// The first one that is heard is the conductor. The chain of its Excitations ends where its
// Measurement says; each chain of which nothing is known yet begins with the first link shown. One
// of contract 2 shows none, and the participant alone tells it from others. The conductor may
// change, to that of another run or to one that resumes the run, only when the caller says so. One
// whose participant is not known any more, as it has ended, is told by its link.
//
// A message costs a hash for every link that may have been shown since the latest (most_links()),
// none where it comes from another participant, and all together no more than `hashes_per_s`. One
// thread.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "idl/dyncal.h"
#include "services/bus/clock.hpp"
#include "services/bus/writer_id.hpp"
#include "services/contract/one_way_chain.hpp"

namespace dyncal::inline programs {

enum class ChainTopic : std::size_t { measurement, excitation };

// What a guard keeps of it over restarts.
struct Conductor {
  std::string run; // empty: none so far
  std::string participant;
  std::array<std::optional<NumberedLink>, 2> links{}; // the latest that counted, by ChainTopic

  friend bool operator==(const Conductor&, const Conductor&) = default;
};

class BelievedConductor {
public:
  using Instant = bus::Clock::Instant;

  // Messages of a conductor that excites steps of a tenth of a second.
  static constexpr int links_per_s = 20;
  static constexpr std::uint64_t spare_links = 64;
  static constexpr std::uint64_t most_links_ever = 4'000'000; // of a run of 14 days
  static constexpr std::uint64_t hashes_per_s = 200'000;      // some 3 % of a processor

  BelievedConductor(Conductor kept, Instant now)
      : conductor_(std::move(kept)), heard_{now, now}, refilled_(now) {}

  // `may_change`: no other one is alive, and the output is known to be off.
  [[nodiscard]] bool believes(const wire::Measurement& measurement, const bus::WriterId& writer,
                              bool may_change, Instant now);
  [[nodiscard]] bool believes(const wire::Excitation& excitation, const bus::WriterId& writer,
                              bool may_change, Instant now);

  [[nodiscard]] const Conductor& conductor() const { return conductor_; }
  [[nodiscard]] Instant heard_at() const { return std::max(heard_[0], heard_[1]); }
  // How many messages were passed over.
  [[nodiscard]] std::uint64_t passed_over() const { return passed_over_; }

private:
  template <class Message>
  bool believes(const Message& message, ChainTopic topic, const bus::WriterId& writer,
                bool may_change, Instant now);
  bool is_next(ChainTopic topic, const std::optional<NumberedLink>& shown, Instant now);
  [[nodiscard]] std::uint64_t most_links(ChainTopic topic, Instant now) const;

  Conductor conductor_;
  std::array<Instant, 2> heard_;      // by topic
  std::array<bool, 2> is_followed_{}; // heard since the start of the guard, or the announcement
  Instant refilled_;
  std::uint64_t hashes_left_ = most_links_ever;
  std::uint64_t passed_over_ = 0;
};

} // namespace dyncal::inline programs
