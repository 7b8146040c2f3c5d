// Reads samples of the channels that somebody looks at, and of no others.
//
// look() names a channel and sees its ring; from then on its bench's samples are read, until nobody
// has looked for `forgotten_after`. The first look sees an empty ring. At most `max_channels`; a
// look at another sees nothing. What blocks say is missing is counted (missed()); no source waits
// for this reader.
//
// Threads: one of its own reads and fills; look() from any, which holds that one up while it looks.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/contract/sample_continuity.hpp"
#include "services/contract/source_kind.hpp"
#include "services/views/signals/channel_ring.hpp"

namespace dyncal::inline views {

struct TappedChannel {
  std::string bench;
  std::string source;
  SourceKind kind = SourceKind::dau;
  std::size_t column = 0; // of the channel in the source's blocks

  // NOLINTNEXTLINE(modernize-use-nullptr): the check takes the comparison for a pointer
  auto operator<=>(const TappedChannel&) const = default;
};

class SignalTap {
public:
  static constexpr std::size_t max_channels = 16;
  static constexpr std::chrono::seconds forgotten_after{5};

  // Both outlive the object.
  SignalTap(bus::Participant& participant, bus::Clock& clock);
  ~SignalTap();
  SignalTap(const SignalTap&) = delete;
  SignalTap& operator=(const SignalTap&) = delete;

  // False: too many channels are looked at already.
  template <class Look>
  [[nodiscard]] bool look(const TappedChannel& channel, Look&& look) {
    const std::lock_guard lock(mutex_);
    Tapped* tapped = find(channel);
    if (tapped == nullptr) {
      return false;
    }
    look(static_cast<const ChannelRing&>(tapped->ring));
    return true;
  }
  [[nodiscard]] std::uint64_t missed() const { return missed_; } // samples
  [[nodiscard]] std::size_t readers() const;

private:
  struct Tapped {
    ChannelRing ring;
    bus::Clock::Instant looked_at{};
  };
  using Topic = std::pair<std::string, SourceKind>; // bench and kind
  struct Readers {
    std::optional<bus::Reader<wire::SampleBlock>> blocks;
    std::optional<bus::Reader<wire::TriggeredRecord>> records;
    std::map<std::string, SampleContinuity> continuity; // by source
  };

  Tapped* find(const TappedChannel& channel);
  void run(const std::stop_token& stop);
  void choose_readers();
  void take(const Topic& topic, Readers& readers);
  void push(const Topic& topic, Readers& readers, const wire::SampleBlock& block);
  void push(const Topic& topic, const wire::TriggeredRecord& record);

  bus::Participant& participant_;
  bus::Clock& clock_;
  std::shared_ptr<bus::WakeUp> wake_up_ = std::make_shared<bus::WakeUp>();
  mutable std::mutex mutex_;
  std::map<TappedChannel, Tapped> channels_;
  std::map<Topic, Readers> readers_; // of the thread, but for their number
  std::atomic<std::uint64_t> missed_ = 0;
  std::atomic<std::size_t> reader_count_ = 0;
  std::jthread thread_; // the last: ended first
};

} // namespace dyncal::inline views
