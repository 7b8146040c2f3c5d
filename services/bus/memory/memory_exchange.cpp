#include "services/bus/memory/memory_exchange.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <fnmatch.h>

namespace dyncal::bus {
namespace {

bool is_in(const std::vector<std::string>& partitions, const MemoryEndpoint& reader) {
  return std::ranges::any_of(partitions, [&](const std::string& partition) {
    return fnmatch(reader.partitions.front().c_str(), partition.c_str(), FNM_NOESCAPE) == 0;
  });
}

bool matches(const MemoryEndpoint& writer, const MemoryEndpoint& reader) {
  return writer.topic == reader.topic && writer.type_name == reader.type_name &&
         (writer.qos.transient_local || !reader.qos.transient_local) &&
         (writer.qos.reliable || !reader.qos.reliable) && is_in(writer.partitions, reader);
}

WriterId writer_id(std::uint32_t participant, std::uint32_t writer) {
  WriterId id;
  std::memcpy(id.guid.data(), &participant, sizeof participant);
  std::memcpy(id.guid.data() + guid_prefix_bytes, &writer, sizeof writer);
  return id;
}

void ring(const MemoryEndpoint& endpoint) {
  if (endpoint.wake_up) {
    endpoint.wake_up->ring();
  }
}

} // namespace

std::uint32_t MemoryExchange::join(const std::string& name) {
  const std::lock_guard lock(mutex_);
  participants_.push_back(name);
  return static_cast<std::uint32_t>(participants_.size());
}

Discovery MemoryExchange::discovered(std::uint32_t by_participant) {
  const std::lock_guard lock(mutex_);
  Discovery discovery;
  for (std::uint32_t number = 1; number <= participants_.size(); ++number) {
    if (number != by_participant) {
      discovery.participants.push_back(
          {writer_id(number, 0).participant(), participants_[number - 1], "memory"});
    }
  }
  return discovery;
}

std::shared_ptr<MemoryWriterState> MemoryExchange::open_writer(MemoryEndpoint endpoint) {
  const std::lock_guard lock(mutex_);
  auto writer = std::make_shared<MemoryWriterState>();
  static_cast<MemoryEndpoint&>(*writer) = std::move(endpoint);
  writer->id = writer_id(writer->participant_number, ++writers_so_far_);
  writers_.push_back(writer);
  for (const auto& reader : readers_) {
    match(*writer, reader);
  }
  return writer;
}

std::shared_ptr<MemoryReaderState> MemoryExchange::open_reader(MemoryEndpoint endpoint) {
  const std::lock_guard lock(mutex_);
  auto reader = std::make_shared<MemoryReaderState>();
  static_cast<MemoryEndpoint&>(*reader) = std::move(endpoint);
  readers_.push_back(reader);
  for (const auto& writer : writers_) {
    match(*writer, reader);
  }
  ring(*reader);
  return reader;
}

void MemoryExchange::match(MemoryWriterState& writer,
                           const std::shared_ptr<MemoryReaderState>& reader) {
  if (!matches(writer, *reader)) {
    return;
  }
  MemoryLink& link = *writer.links.emplace_back(std::make_unique<MemoryLink>());
  link.reader = reader;
  if (!reader->qos.transient_local) {
    return; // a late joiner gets nothing of what was before
  }
  for (const auto& [number, message] : writer.history) {
    send(writer, link, message);
  }
}

void MemoryExchange::close(const std::shared_ptr<MemoryWriterState>& writer) {
  const std::lock_guard lock(mutex_);
  writer->links.clear();
  std::erase(writers_, writer);
}

void MemoryExchange::close(const std::shared_ptr<MemoryReaderState>& reader) {
  const std::lock_guard lock(mutex_);
  for (const auto& writer : writers_) {
    std::erase_if(writer->links, [&](const std::unique_ptr<MemoryLink>& link) {
      if (link->reader != reader) {
        return false;
      }
      for (const auto& [message, due] : link->in_transit) {
        --message->in_transit_to;
      }
      return true;
    });
    ring(*writer);
  }
  std::erase(readers_, reader);
}

bool MemoryExchange::write(MemoryWriterState& writer, MemoryMessage message) {
  const std::lock_guard lock(mutex_);
  if (full_.contains(writer.topic) || !make_room(writer, message.key)) {
    return false;
  }
  message.number = writer.next_number++;
  message.writer = writer.id;
  const auto sent = std::make_shared<MemoryMessage>(std::move(message));
  writer.history.emplace(sent->number, sent);
  writer.numbers_of_key[sent->key].push_back(sent->number);
  for (const auto& link : writer.links) {
    send(writer, *link, sent);
  }
  return true;
}

// Removes what the writer need not hold any longer once there is one message more of this key.
bool MemoryExchange::make_room(MemoryWriterState& writer, const std::string& key) {
  const auto found = writer.numbers_of_key.find(key);
  if (found == writer.numbers_of_key.end()) {
    return true;
  }
  auto& numbers = found->second;
  const auto limit = static_cast<std::size_t>(writer.qos.samples_per_key);
  if (numbers.size() < limit) {
    return true;
  }
  const MemoryMessagePointer& oldest = writer.history.at(numbers.front());
  if (writer.qos.keep_all && oldest->in_transit_to > 0) {
    return false;
  }
  // What has arrived at a reader without room for it is sent no more.
  for (const auto& link : writer.links) {
    std::erase_if(link->in_transit, [&](const MemoryLink::InTransit& one) {
      return one.message == oldest && one.due <= clock_.now();
    });
  }
  writer.history.erase(numbers.front());
  numbers.pop_front();
  return true;
}

void MemoryExchange::forget(MemoryWriterState& writer, const std::string& key) {
  for (const std::uint64_t number : writer.numbers_of_key[key]) {
    writer.history.erase(number);
  }
  writer.numbers_of_key.erase(key);
}

void MemoryExchange::send(MemoryWriterState& writer, MemoryLink& link,
                          const MemoryMessagePointer& message) {
  const MessageInTransit transit{writer.topic,       writer.partitions.front(),
                                 writer.participant, link.reader->participant,
                                 message->number,    *message->payload};
  if (lost_ && lost_(transit)) {
    return;
  }
  auto due = clock_.now();
  if (delay_) {
    due += delay_(transit);
  }
  if (!link.in_transit.empty()) {
    due = std::max(due, link.in_transit.back().due);
  }
  ++message->in_transit_to;
  link.in_transit.push_back({message, due});
  deliver(writer, link);
  if (due > clock_.now()) {
    deliver_later(due);
  }
}

void MemoryExchange::deliver(MemoryWriterState& writer, MemoryLink& link) {
  bool delivered = false;
  while (!link.in_transit.empty() && link.in_transit.front().due <= clock_.now() &&
         accepts(*link.reader, *link.in_transit.front().message)) {
    const MemoryMessagePointer message = link.in_transit.front().message;
    link.in_transit.pop_front();
    --message->in_transit_to;
    accept(*link.reader, message);
    delivered = true;
  }
  if (delivered) {
    ring(*link.reader);
    ring(writer);
  }
}

bool MemoryExchange::accepts(const MemoryReaderState& reader, const MemoryMessage& message) const {
  if (stopped_.contains(reader.participant)) {
    return false;
  }
  const auto untaken = reader.untaken.find(message.key);
  return !reader.qos.keep_all || untaken == reader.untaken.end() ||
         untaken->second < reader.qos.samples_per_key;
}

void MemoryExchange::accept(MemoryReaderState& reader, const MemoryMessagePointer& message) {
  int& untaken = reader.untaken[message->key];
  if (untaken < reader.qos.samples_per_key) {
    ++untaken;
  } else if (!reader.qos.keep_all) {
    reader.queue.erase(std::ranges::find(
        reader.queue, message->key,
        [](const MemoryMessagePointer& one) -> auto& { return one->key; }));
  }
  reader.queue.push_back(message);
}

void MemoryExchange::deliver_later(Clock::Instant due) {
  assert(stepped_ != nullptr); // only a test's own time can be waited for by nobody
  stepped_->at(stepped_->elapsed() + (due - clock_.now()), [exchange = weak_from_this()] {
    if (const auto alive = exchange.lock()) {
      const std::lock_guard lock(alive->mutex_);
      alive->deliver_everything();
    }
  });
}

void MemoryExchange::deliver_everything() {
  for (const auto& writer : writers_) {
    for (const auto& link : writer->links) {
      deliver(*writer, *link);
    }
  }
}

bool MemoryExchange::all_acknowledged(const MemoryWriterState& writer) {
  const std::lock_guard lock(mutex_);
  return std::all_of(writer.links.begin(), writer.links.end(),
                     [](const auto& link) { return link->in_transit.empty(); });
}

int MemoryExchange::matched_readers(const MemoryWriterState& writer) {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(writer.links.size());
}

int MemoryExchange::matched_writers(const MemoryReaderState& reader) {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(std::count_if(writers_.begin(), writers_.end(), [&](const auto& writer) {
    return std::any_of(writer->links.begin(), writer->links.end(),
                       [&](const auto& link) { return link->reader.get() == &reader; });
  }));
}

std::shared_ptr<const MemoryMessage> MemoryExchange::take_next(MemoryReaderState& reader) {
  const std::lock_guard lock(mutex_);
  if (reader.queue.empty() || stopped_.contains(reader.participant)) {
    return nullptr;
  }
  const MemoryMessagePointer message = reader.queue.front();
  reader.queue.pop_front();
  if (const auto untaken = reader.untaken.find(message->key);
      untaken != reader.untaken.end() && --untaken->second == 0) {
    reader.untaken.erase(untaken);
  }
  for (const auto& writer : writers_) {
    for (const auto& link : writer->links) {
      if (link->reader.get() == &reader) {
        deliver(*writer, *link);
      }
    }
  }
  return message;
}

void MemoryExchange::lose(MemoryNetwork::Rule rule) {
  const std::lock_guard lock(mutex_);
  lost_ = std::move(rule);
}

void MemoryExchange::delay(MemoryNetwork::Delay delay) {
  const std::lock_guard lock(mutex_);
  delay_ = std::move(delay);
}

void MemoryExchange::set_stopped(const std::string& participant, bool stopped) {
  const std::lock_guard lock(mutex_);
  if (stopped) {
    stopped_.insert(participant);
    return;
  }
  stopped_.erase(participant);
  deliver_everything();
  for (const auto& reader : readers_) {
    if (reader->participant == participant) {
      ring(*reader);
    }
  }
}

void MemoryExchange::set_full(const std::string& topic, bool full) {
  const std::lock_guard lock(mutex_);
  if (full) {
    full_.insert(topic);
    return;
  }
  full_.erase(topic);
  for (const auto& writer : writers_) {
    ring(*writer);
  }
}

void MemoryExchange::inject(const std::string& topic, const std::string& partition,
                            std::string payload) {
  const std::lock_guard lock(mutex_);
  MemoryMessage message;
  message.key = payload; // nobody else's
  message.payload = std::make_shared<const std::string>(std::move(payload));
  const auto sent = std::make_shared<MemoryMessage>(std::move(message));
  for (const auto& reader : readers_) {
    if (reader->topic == topic && is_in({partition}, *reader)) {
      accept(*reader, sent);
      ring(*reader);
    }
  }
}

} // namespace dyncal::bus
