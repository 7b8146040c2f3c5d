#include "services/records/capture/recording_thread.hpp"

#include <chrono>
#include <utility>

#include <fmt/core.h>
#include <spdlog/spdlog.h>

namespace dyncal::inline records::recording {
namespace {

using base::Expected;
using std::chrono::steady_clock;

constexpr std::chrono::seconds synchronise_interval{1};

std::size_t bytes_of(const Chunk& chunk) {
  return chunk.records().size();
}

} // namespace

RecordingThread::RecordingThread(RecordingWriter writer, std::size_t max_queue_bytes,
                                 std::uint64_t min_free_bytes)
    : writer_(std::move(writer)), max_queue_bytes_(max_queue_bytes),
      min_free_bytes_(min_free_bytes), synchronised_(steady_clock::now()),
      thread_([this] { write(); }) {}

RecordingThread::~RecordingThread() {
  (void)close();
}

bool RecordingThread::has_room(std::size_t bytes) const {
  const std::scoped_lock lock(mutex_);
  return queued_bytes_ + bytes <= max_queue_bytes_;
}

void RecordingThread::put(Chunk chunk) {
  const std::size_t bytes = bytes_of(chunk);
  put(Item(std::move(chunk)), bytes);
}

void RecordingThread::put(Attachment attachment) {
  const std::size_t bytes = attachment.data.size();
  put(Item(std::move(attachment)), bytes);
}

void RecordingThread::put(Item item, std::size_t bytes) {
  const std::scoped_lock lock(mutex_);
  queue_.push_back(std::move(item));
  queued_bytes_ += bytes;
  changed_.notify_all();
}

void RecordingThread::note_losses(Metadata losses) {
  const std::scoped_lock lock(mutex_);
  losses_ = std::move(losses);
}

Expected<void> RecordingThread::close() {
  {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) {
    thread_.join();
  }
  return outcome_;
}

RecordingFigures RecordingThread::figures() const {
  const std::scoped_lock lock(mutex_);
  return figures_;
}

void RecordingThread::write() {
  std::unique_lock lock(mutex_);
  while (!closed_ || !queue_.empty()) {
    changed_.wait_for(lock, synchronise_interval, [&] { return closed_ || !queue_.empty(); });
    if (!queue_.empty()) {
      const Item item = std::move(queue_.front());
      queue_.pop_front();
      lock.unlock();
      write(item);
      lock.lock();
      // Until then it takes part in the bound.
      queued_bytes_ -= std::visit(
          [](const auto& one) {
            if constexpr (std::is_same_v<std::decay_t<decltype(one)>, Chunk>) {
              return bytes_of(one);
            } else {
              return one.data.size();
            }
          },
          item);
    }
    lock.unlock();
    synchronise();
    lock.lock();
  }
  lock.unlock();
  if (!figures_.ended) {
    end("");
  }
}

void RecordingThread::write(const Item& item) {
  const auto* chunk = std::get_if<Chunk>(&item);
  const std::uint64_t messages = chunk != nullptr ? chunk->messages() : 0;
  if (!figures_.ended && writer_.free_bytes() < min_free_bytes_) {
    end(fmt::format("{}: the disk is nearly full ({} MB left), so the recording was ended; make "
                    "room and begin another",
                    writer_.path().string(), writer_.free_bytes() / 1'000'000));
  }
  if (!figures_.ended) {
    const Expected<void> added =
        chunk != nullptr ? writer_.add_chunk(*chunk) : writer_.add_attachment(std::get<1>(item));
    if (!added) {
      end(added.error().message);
    }
    unsynchronised_ = added.has_value();
  }
  const std::scoped_lock lock(mutex_);
  (figures_.ended ? figures_.not_stored : figures_.stored) += messages;
  figures_.file_bytes = writer_.bytes();
  figures_.free_bytes = writer_.free_bytes();
}

void RecordingThread::synchronise() {
  if (!unsynchronised_ || figures_.ended ||
      steady_clock::now() - synchronised_ < synchronise_interval) {
    return;
  }
  if (const auto done = writer_.synchronise(); !done) {
    end(done.error().message);
  }
  unsynchronised_ = false;
  synchronised_ = steady_clock::now();
}

// Only this thread changes the figures, so it may read them without the lock.
void RecordingThread::end(std::string problem) {
  Metadata losses;
  {
    const std::scoped_lock lock(mutex_);
    losses = losses_;
  }
  if (!problem.empty()) {
    spdlog::error("{}", problem);
    losses.entries["ended"] = problem;
  }
  Expected<void> ended;
  if (!losses.name.empty()) {
    ended = writer_.add_metadata(std::move(losses));
  }
  const Expected<void> closed = writer_.close(); // in any case
  const std::scoped_lock lock(mutex_);
  outcome_ = closed ? ended : closed;
  figures_.ended = true;
  figures_.problem = std::move(problem);
  figures_.file_bytes = writer_.bytes();
}

} // namespace dyncal::inline records::recording
