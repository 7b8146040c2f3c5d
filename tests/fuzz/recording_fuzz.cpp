// Any bytes as a recording: everything is read or refused, no message without a chunk whose CRC is
// right, and the places that are damaged lie in the file.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <sys/mman.h>
#include <unistd.h>

#include "services/records/mcap/recording_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dyncal;
  drivers::FileDescriptor file(memfd_create("recording", MFD_CLOEXEC));
  if (pwrite(file.number(), data, size, 0) != static_cast<ssize_t>(size)) {
    return 0;
  }
  auto reader = recording::RecordingReader::read(std::move(file), "fuzzed.mcap");
  if (!reader) {
    return 0;
  }
  std::uint64_t messages = 0;
  const auto report = reader->scan({.message =
                                        [&](const recording::MessageInFile& one) {
                                          ++messages;
                                          if (!reader->chunk_records(one.chunk)) {
                                            std::abort();
                                          }
                                        },
                                    .attachment = [](const recording::Attachment&) {},
                                    .metadata = [](const recording::Metadata&) {}});
  if (!report || report->messages != messages) {
    std::abort();
  }
  for (const recording::Damage& damage : report->damages) {
    if (damage.offset + damage.bytes > size || to_string(damage, "fuzzed.mcap").empty()) {
      std::abort();
    }
  }
  if (report->damage_count == 0 && !report->ended_in_order &&
      std::string_view(reinterpret_cast<const char*>(data), size).find("MCAP0\r\n", 8) ==
          std::string_view::npos) {
    std::abort(); // it has no end, and nobody said so
  }
  return 0;
}
