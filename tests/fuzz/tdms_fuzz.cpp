// Any bytes as a TDMS file: every value is read or the file is refused with its name, and no
// block's sizes contradict each other. The seeds are files of each form (tdms_corpus.cpp).
#include <cstdint>
#include <cstdlib>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "drivers/files/tdms_reader.hpp"
#include "drivers/link/file_descriptor.hpp"

namespace {

using namespace dyncal::drivers;

constexpr std::uint64_t most_samples = 1U << 20U; // a bit of a digital line is a sample

void read(const files::FileSettings& settings) {
  const auto says_where = [&](const Error& error) {
    if (error.message.find(settings.path.string()) == std::string::npos) {
      std::abort();
    }
  };
  auto reader = files::TdmsReader::open(settings);
  if (!reader) {
    says_where(reader.error());
    return;
  }
  const std::size_t channels = (*reader)->description().channels.size();
  for (std::uint64_t next = 0; next < most_samples;) {
    const auto block = (*reader)->read(7);
    if (!block || block->samples == 0) {
      return block ? void() : says_where(block.error());
    }
    if (block->values.size() != block->samples * channels || block->first_sample != next ||
        !block->clock) {
      std::abort();
    }
    next += block->samples;
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FileDescriptor file(memfd_create("tdms", MFD_CLOEXEC));
  if (pwrite(file.number(), data, size, 0) != static_cast<ssize_t>(size)) {
    return 0;
  }
  files::FileSettings settings;
  settings.path = "/proc/self/fd/" + std::to_string(file.number());
  read(settings);
  settings.channel = "a"; // whose length may differ from that of others
  settings.sample_rate = SampleRate{1000, 1};
  read(settings);
  return 0;
}
