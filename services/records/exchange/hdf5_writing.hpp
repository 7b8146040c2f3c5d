// Datasets and attributes as the exporter writes them: chunked, with shuffle, deflate and Fletcher
// checksums, which every reader of HDF5 knows.
//
// Functions return false when the library reports an error, such as a full disk. REQUIRES: a
// Hdf5Lock is held.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "drivers/files/hdf5_library.hpp"

namespace dyncal::inline records {

using drivers::files::Hdf5Handle;

[[nodiscard]] Hdf5Handle make_group(hid_t place, const std::string& name);
[[nodiscard]] bool write_text(hid_t object, const char* name, const std::string& text);
[[nodiscard]] bool write_texts(hid_t object, const char* name,
                               const std::vector<std::string>& texts);
[[nodiscard]] bool write_numbers(hid_t object, const char* name, std::span<const double> numbers);
[[nodiscard]] bool write_count(hid_t object, const char* name, std::uint64_t number);
// A text as a dataset.
[[nodiscard]] bool write_long_text(hid_t place, const std::string& name, std::string_view text);

// `rows` rows of as many numbers as the source has samples, written from the left to the right.
class Hdf5Matrix {
public:
  Hdf5Matrix() = default;
  // `type`: in the file.
  [[nodiscard]] static Hdf5Matrix create(hid_t place, const std::string& name, hid_t type,
                                         std::uint64_t rows, std::uint64_t columns);
  [[nodiscard]] bool is_open() const { return dataset_.is_open(); }
  [[nodiscard]] hid_t id() const { return dataset_.id(); }
  // `count` numbers of each row, row after row; `type`: in memory.
  [[nodiscard]] bool append(const void* numbers, hid_t type, std::uint64_t count);

private:
  Hdf5Handle dataset_;
  std::uint64_t rows_ = 0;
  std::uint64_t written_ = 0; // columns
};

// A list that grows.
class Hdf5List {
public:
  Hdf5List() = default;
  [[nodiscard]] static Hdf5List create(hid_t place, const std::string& name, Hdf5Handle type);
  [[nodiscard]] bool is_open() const { return dataset_.is_open(); }
  [[nodiscard]] bool append(const void* elements, std::uint64_t count);

private:
  Hdf5Handle dataset_;
  Hdf5Handle type_;
  std::uint64_t size_ = 0;
};

// A row of a table names each of its members once, with the value.
using Hdf5Number = std::variant<std::uint32_t, std::uint64_t, std::int64_t, double>;

struct Hdf5Member {
  const char* name;
  Hdf5Number value;
};
using Hdf5Row = std::vector<Hdf5Member>;

// The compound type of rows that have these members.
[[nodiscard]] Hdf5Handle hdf5_type(const Hdf5Row& row);

// Adds the row as it lies in the file and in memory.
void append_row(std::string& bytes, const Hdf5Row& row);

} // namespace dyncal::inline records
