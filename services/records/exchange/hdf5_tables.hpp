// A table of an exported HDF5 file: a row names each of its members once, with the value.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "drivers/files/hdf5_library.hpp"

namespace dyncal::inline records {

using drivers::files::Hdf5Handle;

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
