#include "drivers/files/file_formats.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

#include "drivers/files/csv_reader.hpp"
#include "drivers/files/dump_reader.hpp"
#include "drivers/files/npy_reader.hpp"
#include "drivers/files/sigmf_reader.hpp"
#include "drivers/files/tdms_reader.hpp"
#include "drivers/files/wav_reader.hpp"

#ifdef DYNCAL_HAVE_HDF5
#include "drivers/files/hdf5_reader.hpp"
#endif

namespace dyncal::drivers::files {
namespace {

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
      std::pair("TDSm", "a TDMS file; its name must end in .tdms"),
      std::pair("TDSh", "the index of a TDMS file; name the file itself (.tdms)"),
      std::pair("\x89MCAP", "a recording; give it to 'dyncal analyse' as it is")};
  for (const auto& [magic, kind] : kinds) {
    if (bytes.starts_with(magic)) {
      return kind;
    }
  }
  return bytes.find('\0') == std::string_view::npos
             ? ""
             : "no text; CSV, NumPy (.npy), WAV (.wav), TDMS (.tdms), SigMF (.sigmf-meta) and "
               "files of the SmartUp receiver (.dump, .h5) can be read";
}

} // namespace

Expected<std::unique_ptr<SampleReader>> open_file(const FileSettings& settings) {
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
  if (extension == ".tdms") {
    return open_as<TdmsReader>(settings);
  }
  if (extension == ".sigmf-meta" || extension == ".sigmf-data") {
    return open_as<SigmfReader>(settings);
  }
  if (extension == ".npy") {
    return open_as<NpyReader>(settings);
  }
  if (const std::string kind = kind_of_bytes(settings.path); !kind.empty()) {
    return fail(ErrorCode::malformed, settings.path.string() + ": is " + kind);
  }
  return open_as<CsvReader>(settings);
}

} // namespace dyncal::drivers::files
