#include "services/records/exchange/zip_file.hpp"

#include "services/records/mcap/mcap_record.hpp"

namespace dyncal::inline records {
namespace {

using recording::append_number; // little-endian, as ZIP has it

constexpr std::uint32_t head_mark = 0x04034b50;
constexpr std::uint32_t entry_mark = 0x02014b50;
constexpr std::uint32_t end64_mark = 0x06064b50;
constexpr std::uint32_t locator_mark = 0x07064b50;
constexpr std::uint32_t end_mark = 0x06054b50;
constexpr std::uint32_t version_with_zip64 = 45;
constexpr std::uint32_t names_in_utf8 = 1U << 11U;
constexpr std::uint32_t first_of_1980 = 0x0021; // the earliest date; none is kept
constexpr std::uint32_t zip64_extra = 0x0001;
constexpr std::uint32_t in_extra = 0xFFFFFFFF;
constexpr std::uint32_t in_extra_16 = 0xFFFF;
constexpr std::uint64_t end64_bytes = 44; // behind its size

// What head and directory entry have in common: from the version to the CRC.
void append_common(std::string& out, std::uint32_t crc) {
  append_number(out, version_with_zip64, 2);
  append_number(out, names_in_utf8, 2);
  append_number(out, 0, 2); // stored
  append_number(out, 0, 2);
  append_number(out, first_of_1980, 2);
  append_number(out, crc, 4);
  append_number(out, in_extra, 4);
  append_number(out, in_extra, 4);
}

} // namespace

std::string ZipFile::head_of(const Entry& entry) {
  std::string head;
  append_number(head, head_mark, 4);
  append_common(head, entry.crc);
  append_number(head, entry.name.size(), 2);
  append_number(head, 20, 2);
  head += entry.name;
  append_number(head, zip64_extra, 2);
  append_number(head, 16, 2);
  append_number(head, entry.bytes, 8);
  append_number(head, entry.bytes, 8);
  return head;
}

std::string ZipFile::directory_entry_of(const Entry& entry) {
  std::string text;
  append_number(text, entry_mark, 4);
  append_number(text, version_with_zip64, 2);
  append_common(text, entry.crc);
  append_number(text, entry.name.size(), 2);
  append_number(text, 28, 2);
  append_number(text, 0, 2); // comment
  append_number(text, 0, 2); // disk
  append_number(text, 0, 2);
  append_number(text, 0, 4);
  append_number(text, in_extra, 4);
  text += entry.name;
  append_number(text, zip64_extra, 2);
  append_number(text, 24, 2);
  append_number(text, entry.bytes, 8);
  append_number(text, entry.bytes, 8);
  append_number(text, entry.offset, 8);
  return text;
}

Expected<ZipFile> ZipFile::create(const std::filesystem::path& path) {
  DYNCAL_TRY(auto file, OutputStream::create(path));
  return ZipFile(std::move(file));
}

Expected<void> ZipFile::begin_entry(const std::string& name) {
  return end_entry().and_then([&] {
    entries_.push_back({.name = name, .offset = file_.written()});
    return file_.write(head_of(entries_.back()));
  });
}

Expected<void> ZipFile::write(std::string_view bytes) {
  Entry& entry = entries_.back();
  entry.bytes += bytes.size();
  entry.crc = recording::crc32_of(bytes, entry.crc);
  return file_.write(bytes);
}

Expected<void> ZipFile::end_entry() {
  return entries_.empty() ? Expected<void>{}
                          : file_.overwrite(entries_.back().offset, head_of(entries_.back()));
}

Expected<void> ZipFile::finish() {
  DYNCAL_TRY(end_entry());
  const std::uint64_t begin = file_.written();
  std::string directory;
  for (const Entry& entry : entries_) {
    directory += directory_entry_of(entry);
  }
  const std::uint64_t bytes = directory.size();
  append_number(directory, end64_mark, 4);
  append_number(directory, end64_bytes, 8);
  append_number(directory, version_with_zip64, 2);
  append_number(directory, version_with_zip64, 2);
  append_number(directory, 0, 4);
  append_number(directory, 0, 4);
  append_number(directory, entries_.size(), 8);
  append_number(directory, entries_.size(), 8);
  append_number(directory, bytes, 8);
  append_number(directory, begin, 8);
  append_number(directory, locator_mark, 4);
  append_number(directory, 0, 4);
  append_number(directory, begin + bytes, 8);
  append_number(directory, 1, 4);
  append_number(directory, end_mark, 4);
  append_number(directory, 0, 2);
  append_number(directory, 0, 2);
  append_number(directory, in_extra_16, 2);
  append_number(directory, in_extra_16, 2);
  append_number(directory, in_extra, 4);
  append_number(directory, in_extra, 4);
  append_number(directory, 0, 2);
  return file_.write(directory).and_then([&] { return file_.finish(); });
}

} // namespace dyncal::inline records
