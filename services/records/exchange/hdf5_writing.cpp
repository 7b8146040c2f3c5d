#ifdef DYNCAL_HAVE_HDF5

#include "services/records/exchange/hdf5_writing.hpp"

#include <algorithm>
#include <array>

namespace dyncal::inline records {
namespace {

constexpr hsize_t chunk_columns = 8192;
constexpr hsize_t chunk_elements = 4096;
constexpr unsigned deflate_level = 1; // most of what there is to gain

Hdf5Handle text_type(std::size_t bytes) {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), std::max<std::size_t>(1, bytes));
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

bool write_attribute(hid_t object, const char* name, hid_t type, const Hdf5Handle& space,
                     const void* value) {
  const Hdf5Handle attribute(H5Acreate2(object, name, type, space.id(), H5P_DEFAULT, H5P_DEFAULT),
                             H5Aclose);
  return attribute.is_open() && H5Awrite(attribute.id(), type, value) >= 0;
}

Hdf5Handle list_space(hsize_t size) {
  return {H5Screate_simple(1, &size, nullptr), H5Sclose};
}

Hdf5Handle chunked(std::span<const hsize_t> chunk) {
  Hdf5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(properties.id(), static_cast<int>(chunk.size()), chunk.data());
  H5Pset_shuffle(properties.id());
  if (H5Zfilter_avail(H5Z_FILTER_DEFLATE) > 0) {
    H5Pset_deflate(properties.id(), deflate_level);
  }
  H5Pset_fletcher32(properties.id());
  return properties;
}

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

Hdf5Handle make_group(hid_t place, const std::string& name) {
  return {H5Gcreate2(place, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose};
}

bool write_text(hid_t object, const char* name, const std::string& text) {
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  return write_attribute(object, name, text_type(padded.size()).id(),
                         Hdf5Handle(H5Screate(H5S_SCALAR), H5Sclose), padded.data());
}

bool write_texts(hid_t object, const char* name, const std::vector<std::string>& texts) {
  if (texts.empty()) {
    return true;
  }
  std::size_t longest = 1;
  for (const std::string& text : texts) {
    longest = std::max(longest, text.size());
  }
  std::string all;
  for (const std::string& text : texts) {
    all += text;
    all.append(longest - text.size(), '\0');
  }
  return write_attribute(object, name, text_type(longest).id(), list_space(texts.size()),
                         all.data());
}

bool write_numbers(hid_t object, const char* name, std::span<const double> numbers) {
  return write_attribute(object, name, H5T_NATIVE_DOUBLE, list_space(numbers.size()),
                         numbers.data());
}

bool write_count(hid_t object, const char* name, std::uint64_t number) {
  return write_attribute(object, name, H5T_NATIVE_UINT64,
                         Hdf5Handle(H5Screate(H5S_SCALAR), H5Sclose), &number);
}

bool write_long_text(hid_t place, const std::string& name, std::string_view text) {
  const Hdf5Handle type = text_type(text.size());
  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle dataset(
      H5Dcreate2(place, name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose);
  return dataset.is_open() && H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                       text.empty() ? "" : text.data()) >= 0;
}

Hdf5Matrix Hdf5Matrix::create(hid_t place, const std::string& name, hid_t type, std::uint64_t rows,
                              std::uint64_t columns) {
  const std::array<hsize_t, 2> size{rows, columns};
  const std::array<hsize_t, 2> chunk{1, std::min<hsize_t>(columns, chunk_columns)};
  const Hdf5Handle space(H5Screate_simple(2, size.data(), nullptr), H5Sclose);
  Hdf5Matrix matrix;
  matrix.dataset_ = Hdf5Handle(H5Dcreate2(place, name.c_str(), type, space.id(), H5P_DEFAULT,
                                          chunked(chunk).id(), H5P_DEFAULT),
                               H5Dclose);
  matrix.rows_ = rows;
  return matrix;
}

bool Hdf5Matrix::append(const void* numbers, hid_t type, std::uint64_t count) {
  const Hdf5Handle space(H5Dget_space(dataset_.id()), H5Sclose);
  const std::array<hsize_t, 2> start{0, written_};
  const std::array<hsize_t, 2> size{rows_, count};
  const Hdf5Handle memory(H5Screate_simple(2, size.data(), nullptr), H5Sclose);
  written_ += count;
  return H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, size.data(),
                             nullptr) >= 0 &&
         H5Dwrite(dataset_.id(), type, memory.id(), space.id(), H5P_DEFAULT, numbers) >= 0;
}

Hdf5List Hdf5List::create(hid_t place, const std::string& name, Hdf5Handle type) {
  const hsize_t none = 0;
  const hsize_t any = H5S_UNLIMITED;
  const Hdf5Handle space(H5Screate_simple(1, &none, &any), H5Sclose);
  Hdf5List list;
  list.dataset_ = Hdf5Handle(H5Dcreate2(place, name.c_str(), type.id(), space.id(), H5P_DEFAULT,
                                        chunked({&chunk_elements, 1}).id(), H5P_DEFAULT),
                             H5Dclose);
  list.type_ = std::move(type);
  return list;
}

bool Hdf5List::append(const void* elements, std::uint64_t count) {
  const hsize_t start = size_;
  const hsize_t added = count;
  size_ += count;
  const hsize_t all = size_;
  if (count == 0) {
    return true;
  }
  if (H5Dset_extent(dataset_.id(), &all) < 0) {
    return false;
  }
  const Hdf5Handle space(H5Dget_space(dataset_.id()), H5Sclose);
  const Hdf5Handle memory(H5Screate_simple(1, &added, nullptr), H5Sclose);
  return H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, &start, nullptr, &added, nullptr) >= 0 &&
         H5Dwrite(dataset_.id(), type_.id(), memory.id(), space.id(), H5P_DEFAULT, elements) >= 0;
}

} // namespace dyncal::inline records

#endif
