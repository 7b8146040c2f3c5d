// A recorded file of the bench, or a log of CAN frames, as a source of blocks, for `dyncal
// analyse`.
//
// The file is read in a thread of its own, a bounded stretch ahead of the taker of its blocks; it
// waits there for room, so nothing is lost. The thread ends with the file, with a failure, or when
// the object is destroyed. Everything else belongs to one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "drivers/sample_source.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/contract/source_block.hpp"
#include "services/stream/block_ring.hpp"

namespace dyncal::inline records {

// The next samples of a file, or the end of its stream without any.
struct FileBlock {
  drivers::SampleBlock samples;
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

  // One session, described before it is played; losses show as gaps of the sample numbers.
  void describe(const drivers::SourceDescription& /*description*/) override {}
  void begin_session() override {}
  void count(const drivers::SampleCounts& /*counts*/) override {}
  void warn(const std::string& /*sentence*/) override {}
  void take(drivers::SampleBlock block) override;
  void read();
  void note_time(const SourceBlock& block);

  std::string source_;
  std::unique_ptr<drivers::SampleSource> driver_;
  drivers::SourceDescription description_;
  std::vector<double> factors_; // as unit_factors()
  std::uint64_t number_ = 0;
  std::optional<std::int64_t> first_ns_;
  std::int64_t reached_ns_ = 0;
  std::stop_source abandoned_;
  BlockRing ahead_;
  std::optional<Error> failure_; // of the reading thread; read when the ring gave the end
  std::jthread thread_;          // the last member: it ends before what it uses
};

} // namespace dyncal::inline records
