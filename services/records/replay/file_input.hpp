// A recorded file of the bench, or a log of CAN frames, as a source of blocks, for `dyncal
// analyse`.
//
// The file is read in a thread of its own, a bounded stretch ahead of the taker of its blocks; it
// waits there for room, so nothing is lost. The thread ends with the file, with a failure, or when
// the object is destroyed. Everything else belongs to one thread.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/sample_source.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/contract/source_block.hpp"
#include "services/stream/block_ring.hpp"

namespace dyncal::inline records {

// The next samples of a file, or the end of its stream without any.
struct FileBlock {
  drivers::SampleBlock samples;
  std::optional<drivers::SourceDescription> description{}; // where it has changed before them
  std::uint64_t number = 0;
  bool end_of_stream = false;
};

class FileInput : private drivers::SampleSink {
public:
  // Fails (bad_file) when the source is neither a file nor a log, or with what is wrong with the
  // file.
  [[nodiscard]] static Expected<std::unique_ptr<FileInput>> open(const SourceSettings& settings);
  ~FileInput() override;
  FileInput(const FileInput&) = delete;
  FileInput& operator=(const FileInput&) = delete;

  [[nodiscard]] const std::string& source() const { return source_; }
  [[nodiscard]] const drivers::SourceDescription& description() const { return description_; }
  // How far the samples taken reach, from the first one on, in the file's own time.
  [[nodiscard]] std::int64_t reached_ns() const { return reached_ns_; }

  // Waits for the reading thread. Fails (bad_file) with file and line.
  [[nodiscard]] Expected<FileBlock> next();
  // A view of a block that next() gave.
  [[nodiscard]] SourceBlock view(const FileBlock& block) const;

private:
  FileInput(std::string source, std::unique_ptr<drivers::SampleSource> driver);

  // One session; losses show as gaps of the sample numbers. Called in the reading thread.
  void describe(const drivers::SourceDescription& description) override;
  void begin_session() override {}
  void count(const drivers::SampleCounts& /*counts*/) override {}
  void warn(const std::string& /*sentence*/) override {}
  void take(drivers::SampleBlock block) override;
  void read();
  void take_description(FileBlock& block);
  void note_time(const SourceBlock& block);

  std::string source_;
  std::unique_ptr<drivers::SampleSource> driver_;
  drivers::SourceDescription description_;
  DeviceIdentity identity_;
  std::vector<double> factors_; // as unit_factors()
  std::mutex mutex_;            // of the descriptions to come
  std::deque<std::pair<std::uint64_t, drivers::SourceDescription>> described_; // by the block after
  std::uint64_t offered_ = 0; // blocks, in the reading thread
  std::uint64_t number_ = 0;
  std::optional<std::int64_t> first_ns_;
  std::int64_t reached_ns_ = 0;
  std::stop_source abandoned_;
  BlockRing ahead_;
  std::optional<Error> failure_; // of the reading thread; read when the ring gave the end
  std::jthread thread_;          // the last member: it ends before what it uses
};

} // namespace dyncal::inline records
