// The header of a NumPy file (.npy, format 1 to 3) that holds a one-dimensional structured array:
// names and types of its fields, and how many rows there are. numpy.lib.format documents it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace dyncal::drivers::files {

struct NpyField {
  std::string name;
  char kind = 'f';       // 'i', 'u', 'f'; 'V' for bytes without meaning
  std::size_t size = 8;  // bytes
  std::size_t place = 0; // bytes from the start of a row
};

struct NpyHeader {
  std::vector<NpyField> fields;
  std::size_t rows = 0;
  std::size_t row_bytes = 0;
  std::size_t header_bytes = 0; // the rows follow

  // Fails with the problem in one sentence, for the caller to say in which file.
  [[nodiscard]] static tl::expected<NpyHeader, std::string> of(std::string_view file);
};

} // namespace dyncal::drivers::files
