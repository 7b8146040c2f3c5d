// How fast a recording is written: 64 KiB messages, in chunks with CRC and one fdatasync a second,
// beside a program that only writes the same bytes: recording_load FOLDER [MB]
//
// Then a Recorder at 100 MB/s for some seconds, over the bus of unit tests. Prints MB/s, the ratio,
// and what was not stored; fails when something was lost, or the ratio is below 0.5 (--strict).
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/records/capture/recorder.hpp"
#include "services/records/capture/recording_thread.hpp"

namespace {

using namespace dyncal;
using Clock = std::chrono::steady_clock;

constexpr std::size_t block_bytes = 64 << 10;

double seconds_since(Clock::time_point began) {
  return std::chrono::duration<double>(Clock::now() - began).count();
}

std::string block_data(std::uint32_t number) {
  std::string data(block_bytes, '\0');
  for (std::size_t i = 0; i + 4 < data.size(); i += 8) {
    data[i] = static_cast<char>(number + i);
  }
  return data;
}

double plain_mb_per_s(const std::filesystem::path& path, std::size_t blocks) {
  const std::string data = block_data(1);
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const auto began = Clock::now();
  auto synchronised = began;
  for (std::size_t i = 0; i < blocks; ++i) {
    if (::write(file, data.data(), data.size()) != static_cast<ssize_t>(data.size())) {
      std::exit(1);
    }
    if (seconds_since(synchronised) > 1.0) {
      ::fdatasync(file);
      synchronised = Clock::now();
    }
  }
  ::fsync(file);
  const double seconds = seconds_since(began);
  ::close(file);
  std::filesystem::remove(path);
  return static_cast<double>(blocks * block_bytes) / 1e6 / seconds;
}

double recorded_mb_per_s(const std::filesystem::path& path, std::size_t blocks) {
  recording::WriterOptions options;
  options.library = "recording_load";
  options.channels = {{1, 0, "T", "cdr", {}}};
  const std::string data = block_data(1);
  const auto began = Clock::now();
  {
    recording::RecordingThread thread(recording::RecordingWriter::create(path, options).value(),
                                      std::size_t{64} << 20U, 0);
    for (std::size_t i = 0; i < blocks;) {
      recording::Chunk chunk;
      chunk.reserve(std::size_t{1} << 20U);
      for (; chunk.records().size() < (1U << 20U) && i < blocks; ++i) {
        chunk.add(options.channels[0], {1, static_cast<std::uint32_t>(i), i, i, data});
      }
      while (!thread.has_room(chunk.records().size())) {
        std::this_thread::yield();
      }
      thread.put(std::move(chunk));
    }
    if (!thread.close()) {
      std::exit(1);
    }
  }
  const double seconds = seconds_since(began);
  std::filesystem::remove(path);
  return static_cast<double>(blocks * block_bytes) / 1e6 / seconds;
}

// Messages that were not stored.
std::uint64_t lost_at(double mb_per_s, double seconds, const std::filesystem::path& path) {
  bus::MemoryNetwork network;
  auto source = network.join("source");
  auto own = network.join("recorder");
  auto writer =
      source
          .writer<wire::SampleBlock>(bus::topics::acs_samples, bus::Profile::live_samples, "bench")
          .value();
  recording::RecorderOptions options;
  options.path = path;
  options.bench = "bench";
  options.min_free_bytes = 0;
  auto recorder = recording::Recorder::start(own, options).value();
  wire::SampleBlock block;
  block.bench("bench");
  block.source("acs");
  block.session(1);
  block.channel_count(1);
  block.sample_count(block_bytes / 8);
  block.values().assign(block_bytes / 8, 0.25);
  const auto began = Clock::now();
  std::uint64_t number = 0;
  for (; seconds_since(began) < seconds; ++number) {
    block.block(number);
    block.first_sample(number * block.sample_count());
    writer.write(block);
    std::this_thread::sleep_until(
        began + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
                    static_cast<double>((number + 1) * block_bytes) / 1e6 / mb_per_s)));
  }
  const double rate = static_cast<double>(number * block_bytes) / 1e6 / seconds_since(began);
  const auto status = recorder->stop().value();
  fmt::print("recorder at {:.1f} MB/s: {} of {} blocks stored, {} not, {} missing\n", rate,
             status.stored, number, status.not_stored, status.missing);
  std::filesystem::remove(path);
  // The recorder's own states are in its recording, too.
  return status.not_stored + status.missing + (status.stored < number ? number - status.stored : 0);
}

} // namespace

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  std::filesystem::create_directories(folder);
  const std::size_t megabytes = argc > 2 ? std::stoul(argv[2]) : 200;
  const bool strict = argc > 3 && std::string(argv[3]) == "--strict";
  const std::size_t blocks = megabytes * 1'000'000 / block_bytes;
  const double plain = plain_mb_per_s(folder / "plain", blocks);
  const double recorded = recorded_mb_per_s(folder / "a.mcap", blocks);
  fmt::print("plain {:.0f} MB/s, recorded {:.0f} MB/s, ratio {:.2f}\n", plain, recorded,
             recorded / plain);
  const double seconds = strict ? 20.0 : 2.0;
  const std::uint64_t lost = lost_at(strict ? 100.0 : 20.0, seconds, folder / "b.mcap");
  return lost == 0 && (!strict || recorded / plain >= 0.5) ? 0 : 1;
}
