// A recorded series played as a source: CSV (time column or constant rate), NumPy (.npy), WAV,
// TDMS, SigMF, or a file of the public SmartUp receiver (.dump, .h5), of any kind of instrument.
// README.md has the formats.
//
// The file is read as it is played, never as a whole. Where the stamps of a block are exactly
// equidistant the block carries a RegularClock, otherwise one stamp a sample; either way the stamps
// are those of the file. Pace: at once, in real time or x times faster by the stamps. A sink that
// blocks makes the file wait. Gaps of the sample numbers are counted as lost in the device.
//
// Fails: not_found (file or column), malformed (with file and line), invalid_setting (no time
// column and no rate).
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/link/stop_signal.hpp"
#include "drivers/sample_rate.hpp"
#include "drivers/sample_source.hpp"

namespace dyncal::drivers::files {

// A channel in a file: its name there, with its group and a slash before it where it has one.
struct FileChannel {
  std::filesystem::path path;
  std::string name;
};

struct FileSettings {
  std::filesystem::path path;
  std::string channel{};             // of an own file, with all others left out; "": all
  std::vector<FileChannel> single{}; // channels of one or more files in place of `path`
  double speed = 0.0;                // times real time; 0: at once
  std::optional<SampleRate>
      sample_rate; // needed when there is no time column; nominal rate otherwise
  std::map<std::string, std::string> channels; // name in the file -> name of the channel
  std::map<std::string, std::string> units;    // name of the channel -> D-SI
  TimeBase time_base = TimeBase::utc;
  std::string group{};    // of an HDF5 or TDMS file with several; "": the only one, or all
  double u_stamp_s = 0.0; // standard uncertainty of the stamps in their time base; 0: not known
  std::int64_t time_offset_ns = 0;       // added to every stamp
  std::map<std::string, double> scale{}; // name of the channel -> factor of its values
};

// Reads one format; FileSource does the pacing.
class SampleReader {
public:
  virtual ~SampleReader() = default;
  [[nodiscard]] virtual const SourceDescription& description() const = 0;
  // The next samples, at most `samples` of them, not beyond a gap; no samples: the end of the file.
  [[nodiscard]] virtual Expected<SampleBlock> read(std::size_t samples) = 0;
  // How much of the file has been read: 0 to 1, never falling, 1 when read() has given the end.
  [[nodiscard]] virtual double share_read() const = 0;
};

class FileSource : public SampleSource {
public:
  explicit FileSource(FileSettings settings) : settings_(std::move(settings)) {}

  [[nodiscard]] Expected<SourceDescription> describe() override;
  [[nodiscard]] Expected<void> run(SampleSink& sink) override;
  void stop() override { stop_.raise(); }
  // As SampleReader::share_read(); 0 before the file is described. In the thread of run() only, so
  // by its sink.
  [[nodiscard]] double share_read() const { return reader_ ? reader_->share_read() : 0.0; }

private:
  [[nodiscard]] std::size_t block_samples() const;
  [[nodiscard]] SourceDescription description() const; // REQUIRES: describe()
  // Returns false if a stop was requested.
  [[nodiscard]] bool wait_for_due_time(const SampleBlock& block,
                                       std::chrono::steady_clock::time_point started) const;

  FileSettings settings_;
  StopSignal stop_;
  std::unique_ptr<SampleReader> reader_;
  SampleBlock first_;
};

} // namespace dyncal::drivers::files
