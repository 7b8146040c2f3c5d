// Answers `CatchUpRequest` for all sources of a process, from what they keep.
//
// A request that is repeated is answered once; a new one of the same asker takes the place of the
// one before. One that could not be answered to its end (its reader did not come, or went) may be
// repeated. At most `max_answers` are given at once; who comes later is answered when its request
// is repeated. Each round also moves what is kept to its file (RetransmissionBuffer::tidy).
//
// A round may block for the disk, or for milliseconds in DDS: it has a thread of its own, and
// nothing live waits for it. Belongs to that thread; add() before it starts.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/stream/catch_up_answer.hpp"
#include "services/stream/retransmission_buffer.hpp"

namespace dyncal::inline stream {

class CatchUpServer {
public:
  static constexpr std::size_t max_answers = 32;

  // `participant` and `clock` outlive the object.
  explicit CatchUpServer(bus::Participant& participant, bus::Clock& clock = bus::system_clock());

  // Fails (network) when the bus refuses.
  [[nodiscard]] Expected<void> add(const SourceOptions& source,
                                   std::shared_ptr<RetransmissionBuffer> kept);

  // One round. Returns when the next one is due; it may be earlier, when wake_up() rings.
  bus::Clock::Instant step();
  [[nodiscard]] const std::shared_ptr<bus::WakeUp>& wake_up() const { return wake_up_; }

private:
  struct Source {
    SourceOptions options;
    std::shared_ptr<RetransmissionBuffer> kept;
    std::vector<std::unique_ptr<CatchUpAnswer>> answers; // one an asker
  };
  struct Asked {
    std::string source; // and bench
    std::string asker;
    std::string request;
    bool operator==(const Asked&) const = default;
  };

  void take_requests(const std::string& bench, bus::Reader<wire::CatchUpRequest>& reader);
  void begin(Source& source, CatchUpOptions wish);
  [[nodiscard]] bool step_answers(Source& source);
  [[nodiscard]] std::size_t answers() const;
  [[nodiscard]] static Asked asked(const Source& source, const CatchUpOptions& wish);

  bus::Participant& participant_;
  bus::Clock& clock_;
  const std::shared_ptr<bus::WakeUp> wake_up_;
  std::map<std::string, bus::Reader<wire::CatchUpRequest>> requests_; // by bench
  std::vector<Source> sources_;
  std::deque<Asked> asked_; // the last ones
};

} // namespace dyncal::inline stream
