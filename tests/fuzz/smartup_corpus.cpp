// Writes the datagrams that the fuzzer begins with: smartup_corpus FOLDER
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/unit/drivers/smartup/datagram_writer.hpp"
#include "tests/unit/drivers/smartup/wire_vectors.hpp"

namespace {

using Bytes = std::vector<std::uint8_t>;

void append(Bytes& bytes, const Bytes& more) {
  if (!bytes.empty()) {
    bytes.insert(bytes.end(), {0xf8, 0xf9, 0xfa, 0xfb});
  }
  bytes.insert(bytes.end(), more.begin(), more.end());
}

bool write(const std::filesystem::path& path, const Bytes& bytes) {
  std::ofstream file(path, std::ios::binary);
  for (const auto byte : bytes) {
    file.put(static_cast<char>(byte));
  }
  return file.good();
}

// A unit with the sensors 1, 2 and the ADCs, which restarts and has faults in its stamps.
Bytes stream() {
  Bytes bytes;
  std::int64_t stamp_ns = 1'600'000'000'000'000'000;
  for (std::uint32_t n = 1; n <= 60; n += 3) {
    dyncal::tests::DatagramWriter datagram("DATA");
    for (std::uint32_t i = n; i < n + 3; ++i) {
      stamp_ns += 1'000'000;
      const std::uint32_t number = i > 40 ? i - 40 : i;
      const std::int64_t fault_ns = i % 17 == 16 ? 1'000'000'000 : 0;
      for (const std::uint32_t sensor : {0xbccb0100U, 0xbccb0200U, 0xbccb0a00U}) {
        datagram.data({.sensor = sensor, .sample_number = number, .stamp_ns = stamp_ns + fault_ns});
      }
    }
    append(bytes, datagram.bytes());
  }
  for (const auto& description : dyncal::tests::mpu9250_descriptions(0xbccb0100)) {
    append(bytes, description);
  }
  return bytes;
}

} // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  Bytes all;
  bool good = true;
  for (const auto& vector : dyncal::tests::all_wire_vectors) {
    const auto bytes = dyncal::tests::wire_vector(vector.name);
    good = write(folder / vector.name, bytes) && good;
    append(all, bytes);
  }
  return write(folder / "all", all) && write(folder / "stream", stream()) && good ? 0 : 1;
}
