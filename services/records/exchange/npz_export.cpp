#include <array>
#include <bit>
#include <cstring>

#include <fmt/core.h>

#include "services/records/exchange/row_formats.hpp"
#include "services/records/exchange/zip_file.hpp"

namespace dyncal::inline records {
namespace {

static_assert(std::endian::native == std::endian::little, "rows are written as they lie in memory");

constexpr std::size_t number_bytes = 8; // of every column
constexpr std::size_t fixed_head = 10;  // magic, version, length
constexpr std::size_t alignment = 64;

// The head of a .npy file, format 1.0.
std::string npy_head(const std::string& type, std::uint64_t count) {
  std::string text =
      fmt::format("{{'descr': {}, 'fortran_order': False, 'shape': ({},), }}", type, count);
  text.append(alignment - (fixed_head + text.size() + 1) % alignment, ' ');
  text += '\n';
  std::string head("\x93NUMPY\x01\x00", 8);
  head += static_cast<char>(text.size() & 0xFFU);
  head += static_cast<char>(text.size() >> 8U);
  return head + text;
}

// Names as Python writes them; quotes and backslashes are not in names of columns.
std::string type_of(const RowTable& table) {
  constexpr std::array types{"<i8", "<u8", "<f8"};
  std::string text = "[";
  for (const RowColumn& column : table.columns()) {
    std::string name;
    for (const char c : column.name) {
      name += c == '\'' || c == '\\' ? '_' : c;
    }
    text += fmt::format("{}('{}', '{}')", text.size() > 1 ? ", " : "", name,
                        types[column.none.index()]);
  }
  return text + "]";
}

std::string bytes_of(const Rows& rows) {
  std::string bytes(rows.count * rows.columns.size() * number_bytes, '\0');
  for (std::size_t column = 0; column < rows.columns.size(); ++column) {
    std::visit(
        [&](const auto& values) {
          char* to = bytes.data() + column * number_bytes;
          for (std::size_t row = 0; row < rows.count; ++row) {
            std::memcpy(to, &values[row], number_bytes);
            to += rows.columns.size() * number_bytes;
          }
        },
        rows.columns[column]);
  }
  return bytes;
}

} // namespace

Expected<void> export_npz(const RowExport& wanted) {
  DYNCAL_TRY(auto file, ZipFile::create(wanted.to));
  RowProgress progress(wanted);
  for (const RowTable& table : wanted.tables) {
    auto written = file.begin_entry(table.source().name + ".npy")
                       .and_then([&] { return file.write(npy_head(type_of(table), table.rows())); })
                       .and_then([&] {
                         return progress.for_each(
                             table, [&](const Rows& rows) { return file.write(bytes_of(rows)); });
                       });
    if (!written) {
      return written;
    }
  }
  return file.begin_entry("contents_json.npy")
      .and_then([&] { return file.write(npy_head("'|u1'", wanted.contents.size())); })
      .and_then([&] { return file.write(wanted.contents); })
      .and_then([&] { return file.finish(); });
}

} // namespace dyncal::inline records
