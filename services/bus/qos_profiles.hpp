// The numbers behind the QoS profiles, the same for every vendor; idl/README.md explains them
// to users.
#pragma once

#include <chrono>
#include <cstdint>

#include "services/bus/bus.hpp"

namespace dyncal::bus {

// Blocks of one source that a writer that waits for its readers keeps for late joiners, dropping
// the oldest that everybody has.
inline constexpr int late_joiner_blocks = 1500;

// The same in Fast DDS where packets are long, acknowledged or on their way: a reader's socket then
// holds no more than it reads in some milliseconds.
inline constexpr int fast_dds_window_blocks = 64;

// Blocks of one source that a writer that never waits keeps for repairs, dropping the oldest
// whether everybody has it or not: 5 s of blocks of 20 ms. Bounds its memory to 16 MB a source.
inline constexpr int repair_blocks = 250;

// A block of a secured source is one packet (decisions/25-secured-blocks.md): so many of them stand
// for one, that the same time is kept for repairs and waits at a reader.
inline constexpr int secured_blocks_per_block = 8;

// Records of one source that such a writer keeps: a record may hold megabytes.
inline constexpr int repair_records = 32;

// Blocks of one source that a reader holds for a program that does not take them. Beyond it a
// writer that waits is held back, and one that does not goes on without this reader: no process
// grows without bound because some part of it is stuck.
inline constexpr int untaken_blocks = 1500;

// What a writer that waits for its readers keeps of them when everybody has them, where it also can
// give them to who comes late (Cyclone DDS). A writer in Cyclone DDS sends what it keeps to every
// new reader in Fast DDS: more would hold up a run's beginning on a lossy link.
inline constexpr int paced_late_joiner_blocks = 25;

// The same of a writer that waits for nobody. Readers of live samples want the stream from now on,
// and the bytes of more hold up what they wait for: with 250 blocks the first step of a run came 4
// to 8 s late over 10 Mbit/s.
inline constexpr int live_late_joiner_blocks = 1;

// Blocks of one source on their way to who catches up: the source waits for room.
inline constexpr int catch_up_blocks = 250;

// The same for commands to one target.
inline constexpr int untaken_commands = 1000;

// Probes, or echoes, of one program that a writer has yet to send or a reader has not taken: 2 s of
// them at their usual pace. Beyond it the oldest are lost, as in any other buffer of the way.
inline constexpr int untaken_probes = 200;

// What a writer offers, or a reader asks for.
struct EndpointQos {
  bool transient_local; // late joiners get what the writer keeps
  bool keep_all;        // every sample: who has no room waits. Otherwise the newest of each key
  int samples_per_key;  // kept by a writer; waiting at a reader
  int for_late_joiners; // of a writer, kept when everybody has them; Fast DDS keeps all of the
                        // above
  bool reliable = true; // what is lost comes again; otherwise nobody waits, and it stays lost
  // Of a writer: write() sends, not a thread of the implementation, where up to 1500 blocks may
  // wait. A reader that joins late and asks for what was written before (ours ask for none) may
  // then get a new block before those: never where order is all that it has.
  bool sent_by_write = false;
};

[[nodiscard]] constexpr EndpointQos qos_of_writer(Profile profile, bool secured = false) {
  const int blocks = secured ? secured_blocks_per_block : 1;
  switch (profile) {
  case Profile::samples:
    return {true, true, late_joiner_blocks, late_joiner_blocks};
  case Profile::live_samples:
    return {true, false, blocks * repair_blocks, live_late_joiner_blocks, true, true};
  case Profile::live_records:
    return {true, false, repair_records, repair_records, true, true};
  case Profile::paced_samples:
    return {true, true, late_joiner_blocks, paced_late_joiner_blocks, true, true};
  case Profile::command:
    return {false, true, untaken_commands, 0};
  case Profile::catch_up:
    return {true, true, catch_up_blocks, catch_up_blocks};
  case Profile::probe:
    return {false, false, untaken_probes, 0, false};
  case Profile::results:
  case Profile::state:
    break;
  }
  return {true, false, 1, 1};
}

[[nodiscard]] constexpr EndpointQos qos_of_reader(Profile profile, bool secured = false) {
  const int blocks = secured ? secured_blocks_per_block : 1;
  switch (profile) {
  case Profile::samples:
  case Profile::paced_samples:
    return {true, true, blocks * untaken_blocks, 0};
  case Profile::live_samples:
    return {false, true, blocks * untaken_blocks, 0};
  case Profile::live_records:
    return {false, true, untaken_blocks, 0};
  case Profile::command:
    return {false, true, untaken_commands, 0};
  case Profile::catch_up:
    return {true, true, catch_up_blocks, 0};
  case Profile::probe:
    return {false, false, untaken_probes, 0, false};
  case Profile::results:
  case Profile::state:
    break;
  }
  return {true, false, 1, 0};
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
// Nobody sees in an encrypted packet what it repairs: where packets wait for longer than this to be
// read, each one lost is asked for, and repaired, again and again (decisions/25).
inline constexpr std::chrono::milliseconds fast_dds_secured_heartbeat{100};

// No packet is longer than an Ethernet frame: one lost fragment of a longer datagram stalls the
// reassembly of all others.
inline constexpr int max_udp_payload_bytes = 1472;

// Processes on one host that can be found without multicast, and that a peer's address is tried
// for.
inline constexpr int participants_per_host = 32;

// No message of the contract is longer; a longer one is dropped before room is made for it.
inline constexpr std::uint32_t max_sample_bytes = 64U << 20U;

inline constexpr int wanted_receive_buffer_bytes = 4 << 20;

// Of a socket of Fast DDS where packets are long. After so many bytes it asks its readers what they
// have.
inline constexpr int long_packets_send_buffer_bytes = 256 << 10;

} // namespace dyncal::bus
