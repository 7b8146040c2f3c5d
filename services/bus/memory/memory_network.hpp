// The bus of unit tests: participants of one process that exchange messages through memory, and
// faults on demand.
//
// What crosses it are the bytes that TypeSupport encodes, under the QoS profiles of the contract,
// so a reader meets what it meets on DDS: keys, late joiners, limits of depth, a writer that is
// held back, malformed messages. The tests in tests/unit/services/bus hold it and the vendors to
// the same behaviour. Two things differ: endpoints match at once, and a reader that stops has no
// lease: it holds writers up until it goes on or is destroyed.
//
// Threads: any, as for Participant; with a SteppedClock one. Rules are called while the network is
// locked: they must not use it. No program can be told to use this: it does not leave the process.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/bus/memory/stepped_clock.hpp"

namespace dyncal::bus {

class MemoryExchange;

// A message between a writer and one of its readers.
struct MessageInTransit {
  const std::string& topic;
  const std::string& partition; // the first of its writer's
  const std::string& sender;    // name of the participant
  const std::string& receiver;  // name of the participant
  std::uint64_t number;         // of the writer, counted from 0
  std::string_view payload;

  // The message as a struct of the contract; zeros where it is malformed.
  template <class T>
  [[nodiscard]] T as() const {
    T message;
    type_support<T>().deserialize(&message, payload.data(), payload.size());
    return message;
  }
};

class MemoryNetwork {
public:
  using Rule = std::function<bool(const MessageInTransit&)>;
  using Delay = std::function<std::chrono::nanoseconds(const MessageInTransit&)>;

  // The clock outlives everything that comes from this network.
  explicit MemoryNetwork(Clock& clock = system_clock());
  explicit MemoryNetwork(SteppedClock& clock);

  // `warn` as in ParticipantOptions.
  [[nodiscard]] Participant join(std::string name,
                                 std::function<void(const std::string&)> warn = {});

  // Messages for which the rule holds never arrive, and their writer never learns of it. An empty
  // rule ends the losses.
  void lose(Rule rule);
  // So many of all messages, by a generator with this seed.
  void lose_randomly(double probability, std::uint64_t seed);
  // Messages take that long; those of one writer stay in order. REQUIRES: a SteppedClock.
  void delay(Delay delay);

  // The readers of a participant accept nothing, as those of a stopped process.
  void stop_reading(const std::string& participant);
  void resume_reading(const std::string& participant);

  // Writers of the topic have no room: write() waits for its limit and times out.
  void fill_writers(const std::string& topic);
  void empty_writers(const std::string& topic);

  // Any bytes, to all readers of the topic in that partition, from no writer.
  void inject(const std::string& topic, const std::string& partition, std::string payload);

private:
  std::shared_ptr<MemoryExchange> exchange_;
};

} // namespace dyncal::bus
