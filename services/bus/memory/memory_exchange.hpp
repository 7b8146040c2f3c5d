// What is inside a MemoryNetwork: which writers and readers there are, what each of them holds, and
// how a message gets from one to the other. Only the files of this folder need it.
//
//   write -> history of the writer -> in transit, one queue a reader -> queue of the reader -> take
//
// A message is in transit until its time has come and the reader has room; until then it is not
// acknowledged. A writer that keeps all has room while the oldest message of the key is
// acknowledged by everybody. A writer that keeps the newest always has.
//
// One mutex guards everything. It is never held while a caller's code runs (but for rules) or while
// a thread waits; WakeUp's own mutex is taken inside it, never around it.
#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "services/bus/memory/memory_network.hpp"
#include "services/bus/qos_profiles.hpp"

namespace dyncal::bus {

struct MemoryMessage {
  std::string key;
  EncodedMessage payload;
  WriterId writer{};
  std::uint64_t number = 0;
  int in_transit_to = 0; // readers that have not accepted it
};
using MemoryMessagePointer = std::shared_ptr<MemoryMessage>;

// What a writer and a reader have in common.
struct MemoryEndpoint {
  std::string topic;
  std::string type_name;
  std::vector<std::string> partitions; // of a reader: one pattern
  std::string participant;
  std::uint32_t participant_number = 0; // from 1, of all that joined
  EndpointQos qos{};
  std::shared_ptr<WakeUp> wake_up; // of a writer: rings when there may be room; never empty
};

struct MemoryReaderState : MemoryEndpoint {
  std::deque<MemoryMessagePointer> queue;
  std::map<std::string, int> untaken; // of each key
};

struct MemoryLink {
  struct InTransit {
    MemoryMessagePointer message;
    Clock::Instant due;
  };
  std::shared_ptr<MemoryReaderState> reader;
  std::deque<InTransit> in_transit;
};

struct MemoryWriterState : MemoryEndpoint {
  WriterId id;
  std::uint64_t next_number = 0;
  std::map<std::uint64_t, MemoryMessagePointer> history;
  std::map<std::string, std::deque<std::uint64_t>> numbers_of_key;
  std::vector<std::unique_ptr<MemoryLink>> links;
};

class MemoryExchange : public std::enable_shared_from_this<MemoryExchange> {
public:
  MemoryExchange(Clock& clock, SteppedClock* stepped) : clock_(clock), stepped_(stepped) {}

  [[nodiscard]] Clock& clock() { return clock_; }
  std::uint32_t join(const std::string& name); // the number of a new participant
  // All that have joined, but this one.
  [[nodiscard]] Discovery discovered(std::uint32_t by_participant);
  std::shared_ptr<MemoryWriterState> open_writer(MemoryEndpoint endpoint);
  std::shared_ptr<MemoryReaderState> open_reader(MemoryEndpoint endpoint);
  void close(const std::shared_ptr<MemoryWriterState>& writer);
  void close(const std::shared_ptr<MemoryReaderState>& reader);

  // Returns false if the writer has no room for the message now.
  bool write(MemoryWriterState& writer, MemoryMessage message);
  [[nodiscard]] bool all_acknowledged(const MemoryWriterState& writer);
  [[nodiscard]] int matched_readers(const MemoryWriterState& writer);
  [[nodiscard]] int matched_writers(const MemoryReaderState& reader);
  // Nothing when there is none, or the reader is stopped.
  [[nodiscard]] std::shared_ptr<const MemoryMessage> take_next(MemoryReaderState& reader);

  void lose(MemoryNetwork::Rule rule);
  void delay(MemoryNetwork::Delay delay);
  void set_stopped(const std::string& participant, bool stopped);
  void set_full(const std::string& topic, bool full);
  void inject(const std::string& topic, const std::string& partition, std::string payload);

private:
  void match(MemoryWriterState& writer, const std::shared_ptr<MemoryReaderState>& reader);
  [[nodiscard]] bool make_room(MemoryWriterState& writer, const std::string& key);
  void send(MemoryWriterState& writer, MemoryLink& link, const MemoryMessagePointer& message);
  void deliver(MemoryWriterState& writer, MemoryLink& link);
  [[nodiscard]] bool accepts(const MemoryReaderState& reader, const MemoryMessage& message) const;
  static void accept(MemoryReaderState& reader, const MemoryMessagePointer& message);
  void deliver_later(Clock::Instant due);
  void deliver_everything();
  static void forget(MemoryWriterState& writer, const std::string& key);

  Clock& clock_;
  SteppedClock* stepped_; // the same clock, where time is stepped
  std::mutex mutex_;
  std::vector<std::string> participants_; // names of all that have joined
  std::uint32_t writers_so_far_ = 0;      // opened
  std::vector<std::shared_ptr<MemoryWriterState>> writers_;
  std::vector<std::shared_ptr<MemoryReaderState>> readers_;
  MemoryNetwork::Rule lost_;
  MemoryNetwork::Delay delay_;
  std::set<std::string> stopped_; // participants
  std::set<std::string> full_;    // topics
};

} // namespace dyncal::bus
