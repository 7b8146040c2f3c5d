// The numbers behind the QoS profiles, the same for every vendor; idl/README.md explains them
// to users.
#pragma once

#include <chrono>

#include "services/bus/bus.hpp"

namespace dyncal::bus {

// Blocks of one source that a writer of `samples` keeps for late joiners, dropping the oldest that
// everybody has: 30 s of blocks of 20 ms, 150 s of 100 ms. It bounds what a daemon that runs for
// weeks holds: 60 MB a source for blocks of 40 kB.
inline constexpr int late_joiner_blocks = 1500;

// Blocks of one source that a reader holds for a program that does not take them. Beyond it the
// writer is held back, and the ring before it fills: no process grows without bound because some
// part of it is stuck.
inline constexpr int untaken_blocks = 1500;

// Blocks of one source on their way to who catches up: the source waits for room.
inline constexpr int catch_up_blocks = 250;

// The same for commands to one target.
inline constexpr int untaken_commands = 1000;

struct QosProfile {
  bool transient_local;       // late joiners get what the writer keeps
  bool keep_all;              // every sample; otherwise the newest of each key
  int writer_samples_per_key; // at the writer
  int reader_samples_per_key; // waiting at the reader
};

[[nodiscard]] constexpr QosProfile qos_profile(Profile profile) {
  switch (profile) {
  case Profile::samples:
    return {true, true, late_joiner_blocks, untaken_blocks};
  case Profile::live_samples:
    return {false, true, late_joiner_blocks, untaken_blocks};
  case Profile::command:
    return {false, true, untaken_commands, untaken_commands};
  case Profile::catch_up:
    return {false, true, catch_up_blocks, catch_up_blocks};
  case Profile::results:
  case Profile::state:
    break;
  }
  return {true, false, 1, 1};
}

// One attempt of a vendor's write() waits this long for room in its history; the bus tries again
// until the caller's limit.
inline constexpr std::chrono::milliseconds write_attempt{50};

// A participant that is silent this long is taken for dead: a killed reader holds writers up no
// longer than this.
inline constexpr std::chrono::seconds lease{3};
inline constexpr std::chrono::seconds lease_announcement{1};

// Repairs of lost packets: how often a writer tells readers what there is, how long readers wait
// before they ask.
inline constexpr std::chrono::milliseconds fast_dds_heartbeat{10};

// No packet is longer than an Ethernet frame: one lost fragment of a longer datagram stalls the
// reassembly of all others.
inline constexpr int max_udp_payload_bytes = 1472;

// Processes on one host that can be found without multicast, and that a peer's address is tried
// for.
inline constexpr int participants_per_host = 32;

inline constexpr int wanted_receive_buffer_bytes = 4 << 20;

} // namespace dyncal::bus
