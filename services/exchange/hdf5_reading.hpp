// Datasets and attributes of an HDF5 file, read with every size held against what is there.
// REQUIRES: a Hdf5Lock is held.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/exchange/hdf5_tables.hpp"

namespace dyncal::services {

using drivers::files::hdf5_text;

// None if it is not there.
[[nodiscard]] std::vector<std::string> hdf5_texts(hid_t object, const char* name);
[[nodiscard]] std::vector<double> hdf5_numbers(hid_t object, const char* name);
[[nodiscard]] std::optional<std::uint64_t> hdf5_count(hid_t object, const char* name);
// Nothing if it is not there, or longer.
[[nodiscard]] std::optional<std::string> hdf5_long_text(hid_t place, const char* name,
                                                        std::uint64_t max_bytes);

// A stretch of a dataset in memory, read ahead for whoever goes through it in order: a list, or a
// matrix with rows side by side.
class Hdf5Window {
public:
  // `type` is that of an element in memory, of `element_bytes`.
  Hdf5Window(hid_t place, const std::string& name, Hdf5Handle type, std::size_t element_bytes);

  [[nodiscard]] bool is_open() const { return columns_.has_value(); }
  [[nodiscard]] std::uint64_t rows() const { return rows_; }
  [[nodiscard]] std::uint64_t columns() const { return columns_.value_or(0); }
  // `count` elements of a row from `first` on, which last until the next call for others; null: not
  // there, or not readable. REQUIRES: T is what `type` says, row < rows()
  template <class T>
  [[nodiscard]] const T* at(std::uint64_t first, std::uint64_t count, std::uint64_t row = 0) {
    return static_cast<const T*>(find(first, count, row));
  }

private:
  [[nodiscard]] const void* find(std::uint64_t first, std::uint64_t count, std::uint64_t row);
  [[nodiscard]] bool read(std::uint64_t first, std::uint64_t count);

  Hdf5Handle dataset_;
  Hdf5Handle type_;
  std::size_t element_bytes_;
  int dimensions_ = 1;
  std::uint64_t rows_ = 1;
  std::optional<std::uint64_t> columns_; // nothing: not readable
  std::vector<char> stretch_;
  std::uint64_t first_ = 0; // of the stretch
  std::uint64_t count_ = 0;
};

} // namespace dyncal::services
