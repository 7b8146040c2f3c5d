// Writes small recordings as seeds for recording_fuzz: recording_corpus FOLDER
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "services/records/mcap/recording_writer.hpp"
#include "services/records/mcap/text_crc.hpp"

namespace {

using namespace dyncal::recording;

bool write(const std::filesystem::path& path, Compression compression) {
  std::filesystem::remove(path);
  WriterOptions options;
  options.library = "dyncal seeds";
  options.schemas = {{1, "m::A", "omgidl", "module m { struct A { long a; }; };\n"}};
  options.channels = {{1, 1, "T", "cdr", {{schema_crc_key, schema_crc(options.schemas[0])}}}};
  options.compression = compression;
  auto writer = RecordingWriter::create(path, options);
  if (!writer) {
    return false;
  }
  bool done = writer->add_metadata({"dyncal.recording", {{"bench", "acc-1"}}}).has_value() &&
              writer->add_attachment({1, "recipe.toml", "application/toml", "a"}).has_value();
  for (std::uint32_t chunk_number = 0; chunk_number < 3; ++chunk_number) {
    Chunk chunk;
    const std::string data(100, 'x');
    chunk.add(options.channels[0], {1, chunk_number, 1000 + chunk_number, 1000, data});
    done = done && writer->add_chunk(chunk).has_value();
  }
  return done && writer->close().has_value();
}

} // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  if (!write(folder / "plain", Compression::none) || !write(folder / "zstd", Compression::zstd)) {
    return 1;
  }
  std::ifstream whole(folder / "plain", std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(whole), {}};
  std::ofstream(folder / "cut", std::ios::binary) << text.substr(0, text.size() / 2);
  return text.empty() ? 1 : 0;
}
