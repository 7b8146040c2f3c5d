// The samples of one source on the bus: SampleBlocks numbered within their session, or the
// TriggeredRecords of a source that records after a trigger. An empty message carries a mark: the
// end of the stream, or the run that somebody arms for. Each becomes bytes once; those are sent,
// and kept for who asks for them later. Used by the publishing thread alone.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/stream/retransmission_buffer.hpp"
#include "services/stream/source_publisher.hpp"

namespace dyncal::inline stream {

class StreamWriter {
public:
  // Fails (network) when the bus refuses.
  [[nodiscard]] static Expected<std::unique_ptr<StreamWriter>> create(bus::Participant& participant,
                                                                      const SourceOptions& source);
  virtual ~StreamWriter() = default;

  // Makes the next message out of an entry of the ring; write() tries to hand it over, until it is
  // kept.
  virtual void prepare(RingEntry entry, const std::string& answers_run) = 0;
  [[nodiscard]] virtual bus::WriteOutcome write(std::chrono::nanoseconds limit) = 0;
  // Gives the message away, for who asks for it later. Returns its bytes.
  virtual std::size_t keep_in(RetransmissionBuffer& kept) = 0;
  // Returns whether everything has been acknowledged in time.
  virtual bool wait_for_acknowledgments(std::chrono::nanoseconds limit) = 0;
  [[nodiscard]] virtual int matched_readers() const = 0;
};

} // namespace dyncal::inline stream
