#ifdef DYNCAL_HAVE_HDF5

#include "services/records/exchange/hdf5_tables.hpp"

#include <array>

namespace dyncal::inline records {
namespace {

std::size_t bytes_of(const Hdf5Number& number) {
  return std::visit([](const auto& value) { return sizeof(value); }, number);
}

hid_t type_of(const Hdf5Number& number) {
  const std::array types{H5T_NATIVE_UINT32, H5T_NATIVE_UINT64, H5T_NATIVE_INT64, H5T_NATIVE_DOUBLE};
  return types.at(number.index());
}

} // namespace

Hdf5Handle hdf5_type(const Hdf5Row& row) {
  std::size_t bytes = 0;
  for (const Hdf5Member& member : row) {
    bytes += bytes_of(member.value);
  }
  Hdf5Handle type(H5Tcreate(H5T_COMPOUND, bytes), H5Tclose);
  std::size_t offset = 0;
  for (const Hdf5Member& member : row) {
    H5Tinsert(type.id(), member.name, offset, type_of(member.value));
    offset += bytes_of(member.value);
  }
  return type;
}

void append_row(std::string& bytes, const Hdf5Row& row) {
  for (const Hdf5Member& member : row) {
    std::visit(
        [&](const auto& value) {
          bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
        },
        member.value);
  }
}

} // namespace dyncal::inline records

#endif
