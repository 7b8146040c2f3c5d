// Heartbeats of endpoint discovery, soon and again: what Fast DDS 2.9 does only once a second.
//
// Participants tell each other their writers and readers over reliable endpoints that are built in
// (DDSI-RTPS 8.5.4). What is lost of it comes again when the reader asks, and it asks when it hears
// a heartbeat. Fast DDS sends one when it has found a participant, and then one a second, with no
// setting for it: on a network that loses one packet in five, programs found each other's writers
// and readers after several seconds. Here the newest heartbeat to each destination goes again, with
// the newest sample that was sent there, until the participant there has acknowledged all or it has
// gone max_repeats times.
//
// Destinations are addresses, and a participant that begins often has that of one that has ended:
// a heartbeat that names another participant starts over there.
//
// A reader passes over heartbeats whose count is not greater than the one before, so all that pass
// here are counted again. What is due goes along with the next datagram that is sent anyhow: a
// participant that has just begun announces itself twenty times a second.
//
// Bound: max_destinations, each of one writer; beyond it the new ones have to wait for Fast DDS.
// One thread at a time.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "services/bus/fastdds/screen/rtps_format.hpp"

namespace dyncal::bus {

class DiscoveryHeartbeats {
public:
  using Instant = std::chrono::steady_clock::time_point;
  using Datagram = std::vector<unsigned char>;
  using Destination = std::size_t; // as the caller tells them apart

  static constexpr std::size_t max_repeats = 16;
  static constexpr std::chrono::milliseconds first_repeat{40};
  static constexpr std::chrono::milliseconds next_repeat{120}; // each after the one before
  static constexpr std::size_t max_destinations = 1024;

  // What goes in place of `datagram`, to wherever: the same with its heartbeats of discovery
  // counted again. Nothing where it has no part in discovery.
  [[nodiscard]] std::optional<Datagram> counted(std::span<const unsigned char> datagram);
  // Of a datagram that was counted, for each destination to which it went.
  void sent(std::span<const unsigned char> datagram, Destination destination, Instant now);

  // Of a datagram that came.
  void received(std::span<const unsigned char> datagram);

  struct Due {
    Destination destination;
    Datagram datagram;
  };
  [[nodiscard]] std::vector<Due> due(Instant now);

private:
  using Writer = std::uint32_t;
  static constexpr std::int64_t none = -1; // no sample
  struct Newest {
    Datagram heartbeat;                        // nothing but it and whom it is for
    std::optional<rtps_format::Prefix> whom{}; // the participant; nothing: all that listen there
    std::size_t body = 0;                      // where its body begins in there
    std::int64_t last = none;
    std::size_t repeated = max_repeats;
    Instant next{};
  };

  void keep(Newest& newest, std::int64_t last, Instant now);
  // This participant has all before `base`.
  void acknowledged(const rtps_format::Prefix& whom, Writer writer, std::int64_t base);

  std::map<std::pair<Destination, Writer>, Newest> newest_;
  std::map<Writer, std::uint32_t> counts_;
  Instant earliest_ = Instant::max();
};

} // namespace dyncal::bus
