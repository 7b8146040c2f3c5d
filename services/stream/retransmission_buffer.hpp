// The messages of one source that were written, kept for who was away and asks for them
// (idl/README.md, "Who was away").
//
// The newest few megabytes are in memory at any time. While a run of the bench is under way, and
// for `span` after it, older ones move to a file (ByteLog), so that an idle service writes nothing
// to the disk. Oldest out first: those older than `span`; of the newest run, from the source's
// answer to it on, those older than `run_span`, since who takes a run over needs it from its
// beginning; and those beyond the bound of the file or of its disk, which problem() then reports
// with the minutes that are left.
//
// Threads: keep() and want() may be called from any thread and never wait for the disk; all else
// belongs to the one thread that answers.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "services/bus/type_support.hpp"
#include "services/stream/byte_log.hpp"

namespace dyncal::inline stream {

struct KeptLimits {
  std::chrono::nanoseconds span = std::chrono::minutes(10);
  std::chrono::nanoseconds run_span = std::chrono::hours(4); // of the newest run
  std::size_t memory_bytes = std::size_t{4} << 20U;
  std::size_t max_memory_bytes = std::size_t{32} << 20U; // while the disk is behind
  std::uint64_t file_bytes = std::uint64_t{1} << 30U;
  std::uint64_t min_free_bytes = std::uint64_t{256} << 20U; // left on the disk for others
  std::filesystem::path folder{};                           // empty: folder_for_kept_messages()
};

struct KeptMessage {
  std::uint64_t session = 0;
  std::uint64_t number = 0;     // of the block or shot
  std::string acknowledged_run; // of an answer to ARM
  bus::EncodedMessage payload;  // the bytes that were written; never null
};

class RetransmissionBuffer {
public:
  using Instant = std::chrono::steady_clock::time_point;
  using Place = std::uint64_t; // of a message among all that were ever kept

  explicit RetransmissionBuffer(KeptLimits limits);

  [[nodiscard]] const KeptLimits& limits() const { return limits_; }

  // The next message of the source. The oldest one in memory is dropped, and counted, when the file
  // is so far behind that memory has reached its bound.
  void keep(KeptMessage message, Instant now);
  // A run is under way.
  void want(Instant now);

  // Drops what is too old and moves to the file what memory should not hold.
  void tidy(Instant now);
  [[nodiscard]] bool tidy_due() const; // much has come since the last time

  // Where an answer begins: behind message `after` of `session`; where that session is not known,
  // and if it is 0, at the answer to ARM of `run`, else at the oldest message.
  [[nodiscard]] Place place_behind(std::uint64_t session, std::uint64_t after,
                                   const std::string& run) const;
  [[nodiscard]] Place end() const; // the place of the next message

  struct Found {
    Place place = 0;
    std::uint64_t session = 0;
    std::uint64_t number = 0;
    bus::EncodedMessage payload;
  };
  // The first message at this place or behind it; nothing if there is none yet.
  [[nodiscard]] std::optional<Found> at_or_behind(Place place);

  // Messages that were dropped before their time.
  [[nodiscard]] std::uint64_t not_kept() const;
  // One sentence while fewer minutes are kept than `span`, or not the newest run from its beginning
  // on; else empty.
  [[nodiscard]] std::string problem() const;

private:
  struct Entry {
    Place place = 0;
    std::uint64_t session = 0;
    std::uint64_t number = 0;
    Instant time{};
    std::size_t size = 0;
    std::uint64_t offset = 0;    // in the file, if it has no payload
    bus::EncodedMessage payload; // in memory
  };
  struct Session {
    std::uint64_t session = 0;
    Place begin = 0;
  };
  struct Answer {
    std::string run;
    Place place = 0;
  };

  [[nodiscard]] bool is_of_newest_run(Place place, Instant now) const;
  void drop_old(Instant now);
  void drop_oldest();
  void drop_entry(std::size_t index);
  void note(const KeptMessage& message);
  [[nodiscard]] bool move_oldest_to_file(std::unique_lock<std::mutex>& lock, Instant now);
  // The message at `place` was dropped for want of room.
  void run_short(Place place, Instant now, const std::string& reason);
  [[nodiscard]] Expected<std::uint64_t> append(const std::string& payload);
  [[nodiscard]] std::size_t index_of(Place place) const; // of the first entry there or behind

  const KeptLimits limits_;
  std::optional<ByteLog> file_; // of the thread that answers, without the mutex
  std::string no_file_;         // why there is none

  mutable std::mutex mutex_;
  std::deque<Entry> entries_; // those in the file, then those in memory
  std::size_t in_file_ = 0;   // entries
  std::size_t memory_bytes_ = 0;
  Place next_place_ = 0;
  std::deque<Session> sessions_; // the last ones
  std::deque<Answer> answers_;   // the last ones
  std::optional<Instant> wanted_until_;
  std::uint64_t not_kept_ = 0;
  std::optional<Instant> short_since_; // dropped for want of room, lately
  Place short_place_ = 0;              // the last one that was
  std::string problem_;
};

} // namespace dyncal::inline stream
