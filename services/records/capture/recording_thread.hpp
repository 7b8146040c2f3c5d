// Writes chunks into a recording by a thread of its own: anyone who receives messages never waits
// for the disk.
//
// Queue: bound max_queue_bytes of chunks that are not written yet; the caller asks has_room() and
// counts what it leaves out. Every chunk is in the file when it counts as stored; the file is
// synchronised with the disk once a second while there is something new. The recording is ended in
// order when the disk has less than min_free_bytes or a write fails; chunks that come afterwards
// are counted. figures() from any thread, everything else from the owner's.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <variant>

#include "services/records/mcap/recording_writer.hpp"

namespace dyncal::inline records::recording {

struct RecordingFigures {
  std::uint64_t stored = 0;     // messages that are in the file
  std::uint64_t not_stored = 0; // messages of chunks that came too late
  std::uint64_t file_bytes = 0;
  std::uint64_t free_bytes = 0;
  bool ended = false;
  std::string problem; // why it ended by itself
};

class RecordingThread {
public:
  RecordingThread(RecordingWriter writer, std::size_t max_queue_bytes,
                  std::uint64_t min_free_bytes);
  ~RecordingThread(); // writes what is queued, and ends the file
  RecordingThread(const RecordingThread&) = delete;
  RecordingThread& operator=(const RecordingThread&) = delete;

  // Whether a chunk of this size would be within the bound.
  [[nodiscard]] bool has_room(std::size_t bytes) const;
  // REQUIRES: has_room(), unless it is for the caller to answer for the bound.
  void put(Chunk chunk);
  void put(Attachment attachment);
  // What is to stand in the file as its losses when it ends; the newest counts.
  void note_losses(Metadata losses);
  // Writes what is queued and ends the file. Fails (bad_file) when the file has no end in order.
  base::Expected<void> close();

  [[nodiscard]] RecordingFigures figures() const;

private:
  using Item = std::variant<Chunk, Attachment>;

  void put(Item item, std::size_t bytes);
  void write();
  void write(const Item& item);
  void end(std::string problem);
  void synchronise();

  RecordingWriter writer_; // of the thread
  const std::size_t max_queue_bytes_;
  const std::uint64_t min_free_bytes_;
  bool unsynchronised_ = false; // of the thread
  std::chrono::steady_clock::time_point synchronised_;
  mutable std::mutex mutex_; // of all below
  std::condition_variable changed_;
  std::deque<Item> queue_;
  std::size_t queued_bytes_ = 0;
  bool closed_ = false;
  Metadata losses_;
  RecordingFigures figures_;
  base::Expected<void> outcome_;
  std::jthread thread_; // the last member: it ends before what it uses
};

} // namespace dyncal::inline records::recording
