// The answer of one source to one who was away: what is kept behind a message, as it was written,
// by a writer of its own in the partition of the asker.
//
// It waits until a reader has matched, gives everything up to the newest message, and then an empty
// message that names the request. It goes as fast as the reader acknowledges, with so little on the
// wire at once that live messages find their way beside it. It ends early when no reader comes, the
// reader goes, or nothing is acknowledged for long. Belongs to the thread that answers.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "services/bus/bus.hpp"
#include "services/stream/retransmission_buffer.hpp"
#include "services/stream/source_publisher.hpp"
#include "services/stream/write_pace.hpp"

namespace dyncal::inline stream {

// What somebody asks for; `after` is the number of the last block or shot they have.
struct CatchUpOptions {
  std::string asker;
  std::string request;
  std::string run;
  std::uint64_t session = 0;
  std::uint64_t after = 0;
};

// Messages of one type, to one partition.
class CatchUpWriter {
public:
  // Fails (bad_argument) if the asker's name cannot be a partition, (network) if the bus refuses.
  [[nodiscard]] static Expected<std::unique_ptr<CatchUpWriter>>
  create(bus::Participant& participant, const SourceOptions& source, const std::string& asker);
  virtual ~CatchUpWriter() = default;

  // The bytes of a message that was kept; damaged ones are left out.
  [[nodiscard]] virtual bus::WriteOutcome write(const bus::EncodedMessage& payload) = 0;
  // The empty message at the end.
  [[nodiscard]] virtual bus::WriteOutcome write_end(std::uint64_t session, std::uint64_t number,
                                                    const std::string& request) = 0;
  [[nodiscard]] virtual bool acknowledged() = 0;
  [[nodiscard]] virtual int matched_readers() const = 0;
};

class CatchUpAnswer {
public:
  using Instant = std::chrono::steady_clock::time_point;
  enum class State { waiting, giving, closing, given, broken_off };

  CatchUpAnswer(CatchUpOptions wish, std::shared_ptr<RetransmissionBuffer> kept,
                std::unique_ptr<CatchUpWriter> writer, Instant now);

  [[nodiscard]] const CatchUpOptions& wish() const { return wish_; }
  [[nodiscard]] std::uint64_t messages_given() const { return messages_given_; }

  // Writes some of what is left. Afterwards `given` and `broken_off` are final.
  State step(Instant now);

private:
  [[nodiscard]] bool reader_is_gone(Instant now);
  State give(Instant now);
  [[nodiscard]] bool give_next(Instant now);
  [[nodiscard]] bool give_end(Instant now);

  const CatchUpOptions wish_;
  const std::shared_ptr<RetransmissionBuffer> kept_;
  const std::unique_ptr<CatchUpWriter> writer_;
  WritePace pace_;
  State state_ = State::waiting;
  RetransmissionBuffer::Place next_ = 0;
  RetransmissionBuffer::Place end_ = 0;
  bool end_is_final_ = false;
  std::uint64_t session_; // of the newest message given
  std::uint64_t number_;
  std::uint64_t messages_given_ = 0;
  Instant reader_seen_;
  Instant progress_;
};

} // namespace dyncal::inline stream
