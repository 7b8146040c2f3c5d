// Any text as the metadata of a SigMF recording of 96 bytes: its samples are read or it is refused
// with its name, sample numbers rise, and no block's sizes contradict each other.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

#include "drivers/files/sigmf_reader.hpp"

namespace {

using namespace dyncal::drivers;

// In memory, and gone with the process.
std::filesystem::path recording() {
  static const struct Folder {
    std::filesystem::path path = "/dev/shm/dyncal_sigmf_fuzz_" + std::to_string(getpid());
    Folder() {
      std::filesystem::create_directories(path);
      std::ofstream(path / "r.sigmf-data", std::ios::binary) << std::string(96, '\x41');
    }
    ~Folder() { std::filesystem::remove_all(path); }
  } folder;
  return folder.path / "r.sigmf-meta";
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  files::FileSettings settings;
  settings.path = recording();
  std::ofstream(settings.path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  const auto says_where = [](const Error& error) {
    if (error.message.find("/r.sigmf-") == std::string::npos) {
      std::abort();
    }
    return 0;
  };
  auto reader = files::SigmfReader::open(settings);
  if (!reader) {
    return says_where(reader.error());
  }
  const std::size_t channels = (*reader)->description().channels.size();
  std::uint64_t next = 0;
  for (;;) {
    const auto block = (*reader)->read(7);
    if (!block) {
      return says_where(block.error());
    }
    if (block->samples == 0) {
      return 0;
    }
    if (block->values.size() != block->samples * channels || block->first_sample < next ||
        !block->clock) {
      std::abort();
    }
    next = block->first_sample + block->samples;
  }
}
