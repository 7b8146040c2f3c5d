// Any bytes as a dump of the SmartUp receiver: every row is read or the file is refused with its
// name and line, and no block's sizes contradict each other.
#include <cstdint>
#include <cstdlib>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "drivers/files/dump_reader.hpp"
#include "drivers/link/file_descriptor.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dyncal::drivers;
  const FileDescriptor file(memfd_create("dump", MFD_CLOEXEC));
  if (pwrite(file.number(), data, size, 0) != static_cast<ssize_t>(size)) {
    return 0;
  }
  files::FileSettings settings;
  settings.path = "/proc/self/fd/" + std::to_string(file.number());
  settings.channels = {{"Data_11", "sync"}};
  const auto says_where = [&](const Error& error) {
    if (error.message.find(settings.path.string()) == std::string::npos) {
      std::abort();
    }
    return 0;
  };
  auto reader = files::DumpReader::open(settings);
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
        (!block->clock && block->stamps_ns.size() != block->samples)) {
      std::abort();
    }
    next = block->first_sample + block->samples;
  }
}
