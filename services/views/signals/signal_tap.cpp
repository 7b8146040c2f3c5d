#include "services/views/signals/signal_tap.hpp"

#include <cmath>
#include <set>
#include <vector>

#include "services/contract/source_block.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::chrono::milliseconds max_wait{100};
// Blocks come every 20 ms: waking up once for several saves most of the work of waking up.
constexpr std::chrono::milliseconds pause{20};

std::vector<std::int64_t> stamps_of(const SourceBlock& block) {
  if (!block.stamps_ns.empty()) {
    return {block.stamps_ns.begin(), block.stamps_ns.end()};
  }
  std::vector<std::int64_t> stamps_ns(block.samples);
  for (std::size_t i = 0; i < block.samples; ++i) {
    stamps_ns[i] = block.clock.stamp_ns(block.first_sample + i);
  }
  return stamps_ns;
}

} // namespace

SignalTap::SignalTap(bus::Participant& participant, bus::Clock& clock)
    : participant_(participant), clock_(clock),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

SignalTap::~SignalTap() {
  thread_.request_stop();
  wake_up_->ring();
}

std::size_t SignalTap::readers() const {
  return reader_count_;
}

SignalTap::Tapped* SignalTap::find(const TappedChannel& channel) {
  auto found = channels_.find(channel);
  if (found == channels_.end()) {
    if (channels_.size() >= max_channels) {
      return nullptr;
    }
    found = channels_.try_emplace(channel).first;
    wake_up_->ring();
  }
  found->second.looked_at = clock_.now();
  return &found->second;
}

void SignalTap::run(const std::stop_token& stop) {
  bus::WakeUp pacing;
  while (!stop.stop_requested()) {
    clock_.wait(*wake_up_, clock_.now() + max_wait);
    choose_readers();
    for (auto& [topic, readers] : readers_) {
      take(topic, readers);
    }
    if (!readers_.empty()) {
      clock_.wait(pacing, clock_.now() + pause);
    }
  }
}

void SignalTap::choose_readers() {
  std::set<Topic> wanted;
  {
    const std::lock_guard lock(mutex_);
    const bus::Clock::Instant now = clock_.now();
    std::erase_if(channels_, [&](const auto& channel) {
      return now - channel.second.looked_at > forgotten_after;
    });
    for (const auto& [channel, tapped] : channels_) {
      wanted.insert({channel.bench, channel.kind});
    }
  }
  std::erase_if(readers_, [&](const auto& readers) { return !wanted.contains(readers.first); });
  for (const Topic& topic : wanted) {
    if (readers_.contains(topic)) {
      continue;
    }
    const char* name = sample_topic(topic.second);
    Readers& readers = readers_[topic];
    if (is_triggered(topic.second)) {
      const bus::Topic<wire::TriggeredRecord> records{name, bus::Profile::live_records};
      if (auto reader = participant_.reader(records, topic.first, wake_up_)) {
        readers.records.emplace(std::move(*reader));
      }
    } else {
      const bus::Topic<wire::SampleBlock> blocks{name, bus::Profile::live_samples};
      if (auto reader = participant_.reader(blocks, topic.first, wake_up_)) {
        readers.blocks.emplace(std::move(*reader));
      }
    }
  }
  reader_count_ = readers_.size();
}

void SignalTap::take(const Topic& topic, Readers& readers) {
  if (readers.blocks) {
    readers.blocks->take([&](const wire::SampleBlock& block) { push(topic, readers, block); });
  }
  if (readers.records) {
    readers.records->take([&](const wire::TriggeredRecord& record) { push(topic, record); });
  }
}

void SignalTap::push(const Topic& topic, Readers& readers, const wire::SampleBlock& message) {
  const SourceBlock block = view_block(message);
  const std::string source = message.source().to_string();
  if (!block.is_consistent() ||
      (readers.continuity.size() >= max_channels && !readers.continuity.contains(source))) {
    return;
  }
  const ContinuityFinding finding = readers.continuity[source].add(block);
  missed_ += finding.missing_blocks > 0 ? finding.missing_samples : 0;
  if (finding.duplicate || block.samples == 0) {
    return;
  }
  std::vector<std::int64_t> stamps_ns;
  const std::lock_guard lock(mutex_);
  for (auto& [channel, tapped] : channels_) {
    const bool is_of_it = channel.bench == topic.first && channel.kind == topic.second &&
                          channel.source == source && channel.column < block.channels;
    if (!is_of_it) {
      continue;
    }
    if (stamps_ns.empty()) {
      stamps_ns = stamps_of(block);
    }
    tapped.ring.push(stamps_ns, block.values.subspan(channel.column * block.samples, block.samples),
                     finding.missing_samples > 0, message.received_utc_ns(), clock_.now());
  }
}

void SignalTap::push(const Topic& topic, const wire::TriggeredRecord& record) {
  const std::size_t samples = record.sample_count();
  const bool is_whole = samples > 0 && record.interval_s() > 0.0 &&
                        std::isfinite(record.interval_s() * static_cast<double>(samples)) &&
                        std::isfinite(record.first_sample_s()) &&
                        record.values().size() == samples * record.channel_count();
  if (!is_whole) {
    return;
  }
  std::vector<std::int64_t> stamps_ns(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const double since_s = record.first_sample_s() + static_cast<double>(i) * record.interval_s();
    stamps_ns[i] = record.trigger_utc_ns() + std::llround(since_s * 1e9);
  }
  const std::string source = record.source().to_string();
  const std::lock_guard lock(mutex_);
  for (auto& [channel, tapped] : channels_) {
    if (channel.bench == topic.first && channel.kind == topic.second && channel.source == source &&
        channel.column < record.channel_count()) {
      tapped.ring.clear(); // a shot is looked at by itself
      tapped.ring.push(stamps_ns,
                       std::span(record.values()).subspan(channel.column * samples, samples), false,
                       record.received_utc_ns(), clock_.now());
    }
  }
}

} // namespace dyncal::inline views
