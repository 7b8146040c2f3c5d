#include "drivers/files/file_source.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <string_view>
#include <utility>

#include "drivers/files/csv_reader.hpp"
#include "drivers/files/dump_reader.hpp"
#include "drivers/files/npy_reader.hpp"
#include "drivers/files/wav_reader.hpp"
#include "drivers/utc_clock.hpp"

#ifdef DYNCAL_HAVE_HDF5
#include "drivers/files/hdf5_reader.hpp"
#endif

namespace dyncal::drivers::files {
namespace {

constexpr std::size_t max_block = 4096; // samples
constexpr double paced_block_s = 0.05;

std::int64_t stamp_of(const SampleBlock& block, std::size_t i) {
  return block.clock ? block.clock->stamp_ns(block.first_sample + i) : block.stamps_ns[i];
}

template <class Reader>
Expected<std::unique_ptr<SampleReader>> open_as(const FileSettings& settings) {
  DYNCAL_TRY(auto reader, Reader::open(settings));
  return std::unique_ptr<SampleReader>(std::move(reader));
}

// What a file is that its name calls text, by its first bytes: "" where they may be text.
std::string kind_of_bytes(const std::filesystem::path& path) {
  std::array<char, 512> first{};
  std::ifstream file(path, std::ios::binary);
  file.read(first.data(), first.size());
  const std::string_view bytes(first.data(), static_cast<std::size_t>(file.gcount()));
  constexpr std::array kinds{
      std::pair("PK\x03\x04", "an archive (NPZ, XLSX, ZIP ...), not text; write the array in it "
                              "with numpy.save as .npy, with the fields t_ns and one a channel, or "
                              "as CSV"),
      std::pair("\x93NUMPY", "a NumPy file; its name must end in .npy"),
      std::pair("\x89HDF", "an HDF5 file; its name must end in .h5"),
      std::pair("RIFF", "a RIFF file; as WAV its name must end in .wav"),
      std::pair("\x89MCAP", "a recording; give it to 'dyncal analyse' as it is")};
  for (const auto& [magic, kind] : kinds) {
    if (bytes.starts_with(magic)) {
      return kind;
    }
  }
  return bytes.find('\0') == std::string_view::npos
             ? ""
             : "no text; CSV, NumPy (.npy), WAV (.wav) and files of the SmartUp receiver (.dump, "
               ".h5) can be read";
}

Expected<std::unique_ptr<SampleReader>> open_reader(const FileSettings& settings) {
  std::string extension = settings.path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".wav") {
    return open_as<WavReader>(settings);
  }
  if (extension == ".dump") {
    return open_as<DumpReader>(settings);
  }
  if (extension == ".h5" || extension == ".hdf5") {
#ifdef DYNCAL_HAVE_HDF5
    return open_as<Hdf5Reader>(settings);
#else
    return fail(ErrorCode::not_found,
                settings.path.string() + ": this build cannot read HDF5 (Debian: libhdf5-dev)");
#endif
  }
  if (extension == ".npy") {
    return open_as<NpyReader>(settings);
  }
  if (const std::string kind = kind_of_bytes(settings.path); !kind.empty()) {
    return fail(ErrorCode::malformed, settings.path.string() + ": is " + kind);
  }
  return open_as<CsvReader>(settings);
}

} // namespace

Expected<SourceDescription> FileSource::describe() {
  DYNCAL_TRY(reader_, open_reader(settings_));
  // Two samples tell the pace, and a file that is wrong from its first row on is refused before
  // anything is announced.
  DYNCAL_TRY(auto first, reader_->read(2));
  if (first.samples == 0) {
    return fail(ErrorCode::malformed,
                settings_.path.string() + ": no samples below the names of the columns");
  }
  first_ = std::move(first);
  return description();
}

SourceDescription FileSource::description() const {
  SourceDescription description = reader_->description();
  if (settings_.u_stamp_s > 0.0) {
    description.stamp_uncertainty_s = settings_.u_stamp_s;
  }
  return description;
}

std::size_t FileSource::block_samples() const {
  const auto interval_ns = first_.samples < 2 ? 0 : stamp_of(first_, 1) - stamp_of(first_, 0);
  if (settings_.speed <= 0.0 || interval_ns <= 0) {
    return max_block;
  }
  const double samples = paced_block_s * 1e9 * settings_.speed / static_cast<double>(interval_ns);
  return static_cast<std::size_t>(std::clamp(samples, 1.0, static_cast<double>(max_block)));
}

bool FileSource::wait_for_due_time(const SampleBlock& block,
                                   std::chrono::steady_clock::time_point started) const {
  if (settings_.speed <= 0.0) {
    return !stop_.raised();
  }
  const std::int64_t played_ns = stamp_of(block, block.samples - 1) - stamp_of(first_, 0);
  const auto due = started + std::chrono::nanoseconds(static_cast<std::int64_t>(
                                 static_cast<double>(played_ns) / settings_.speed));
  return !stop_.wait_for(std::max(due - std::chrono::steady_clock::now(),
                                  std::chrono::steady_clock::duration::zero()));
}

Expected<void> FileSource::run(SampleSink& sink) {
  const auto started = std::chrono::steady_clock::now();
  const std::size_t samples = block_samples();
  sink.begin_session();
  sink.describe(description());
  SampleCounts counts;
  std::optional<std::uint64_t> next_sample;
  SampleBlock block = first_;
  while (block.samples > 0 && wait_for_due_time(block, started)) {
    block.received_utc_ns = utc_now_ns();
    counts.add(block, next_sample);
    counts.stamps_not_trusted += static_cast<std::uint64_t>(std::count_if(
        block.flags.begin(), block.flags.end(), [](auto flags) { return flags != 0; }));
    sink.take(std::move(block));
    sink.count(counts);
    DYNCAL_TRY(block, reader_->read(samples));
  }
  return {};
}

} // namespace dyncal::drivers::files
