#ifdef DYNCAL_HAVE_HDF5

#include "services/exchange/hdf5_reading.hpp"

#include <algorithm>
#include <array>

namespace dyncal::services {
namespace {

constexpr std::uint64_t stretch_columns = 65536;
constexpr std::uint64_t max_rows = 4096; // channels
constexpr std::uint64_t max_stretch_bytes = std::uint64_t{512} << 20U;
constexpr std::size_t max_text_bytes = 4096;
constexpr hssize_t max_texts = 100'000;

struct OpenedAttribute {
  Hdf5Handle attribute;
  Hdf5Handle type;
  hssize_t count = 0;
};

std::optional<OpenedAttribute> open_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) {
    return std::nullopt;
  }
  OpenedAttribute opened;
  opened.attribute = Hdf5Handle(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (!opened.attribute.is_open()) {
    return std::nullopt;
  }
  opened.type = Hdf5Handle(H5Aget_type(opened.attribute.id()), H5Tclose);
  const Hdf5Handle space(H5Aget_space(opened.attribute.id()), H5Sclose);
  opened.count = space.is_open() ? H5Sget_simple_extent_npoints(space.id()) : 0;
  return opened.type.is_open() && opened.count > 0 && opened.count <= max_texts
             ? std::optional(std::move(opened))
             : std::nullopt;
}

std::string without_padding(const char* text, std::size_t bytes) {
  std::string copy(text, bytes);
  const std::size_t last = copy.find_last_not_of('\0');
  copy.resize(last == std::string::npos ? 0 : last + 1);
  return copy;
}

} // namespace

std::vector<std::string> hdf5_texts(hid_t object, const char* name) {
  std::vector<std::string> texts;
  const auto opened = open_attribute(object, name);
  if (!opened || H5Tget_class(opened->type.id()) != H5T_STRING ||
      H5Tis_variable_str(opened->type.id()) > 0) {
    return texts;
  }
  const std::size_t bytes = H5Tget_size(opened->type.id());
  const auto count = static_cast<std::size_t>(opened->count);
  std::vector<char> all(bytes <= max_text_bytes ? bytes * count : 0);
  if (all.empty() || H5Aread(opened->attribute.id(), opened->type.id(), all.data()) < 0) {
    return texts;
  }
  for (std::size_t i = 0; i < count; ++i) {
    texts.push_back(without_padding(all.data() + i * bytes, bytes));
  }
  return texts;
}

std::vector<double> hdf5_numbers(hid_t object, const char* name) {
  const auto opened = open_attribute(object, name);
  std::vector<double> numbers(opened ? static_cast<std::size_t>(opened->count) : 0);
  if (opened && H5Aread(opened->attribute.id(), H5T_NATIVE_DOUBLE, numbers.data()) < 0) {
    numbers.clear();
  }
  return numbers;
}

std::optional<std::uint64_t> hdf5_count(hid_t object, const char* name) {
  const auto opened = open_attribute(object, name);
  std::uint64_t number = 0;
  return opened && opened->count == 1 &&
                 H5Aread(opened->attribute.id(), H5T_NATIVE_UINT64, &number) >= 0
             ? std::optional(number)
             : std::nullopt;
}

std::optional<std::string> hdf5_long_text(hid_t place, const char* name, std::uint64_t max_bytes) {
  if (place < 0 || H5Lexists(place, name, H5P_DEFAULT) <= 0) {
    return std::nullopt;
  }
  const Hdf5Handle dataset(H5Dopen2(place, name, H5P_DEFAULT), H5Dclose);
  const Hdf5Handle type(dataset.is_open() ? H5Dget_type(dataset.id()) : H5I_INVALID_HID, H5Tclose);
  if (!type.is_open() || H5Tget_class(type.id()) != H5T_STRING ||
      H5Tis_variable_str(type.id()) > 0) {
    return std::nullopt;
  }
  const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
  const std::size_t bytes = H5Tget_size(type.id());
  if (H5Sget_simple_extent_npoints(space.id()) != 1 || bytes > max_bytes) {
    return std::nullopt;
  }
  std::vector<char> text(bytes);
  if (H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0) {
    return std::nullopt;
  }
  return without_padding(text.data(), bytes);
}

Hdf5Window::Hdf5Window(hid_t place, const std::string& name, Hdf5Handle type,
                       std::size_t element_bytes)
    : type_(std::move(type)), element_bytes_(element_bytes) {
  if (H5Lexists(place, name.c_str(), H5P_DEFAULT) <= 0) {
    return;
  }
  dataset_ = Hdf5Handle(H5Dopen2(place, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset_.is_open()) {
    return;
  }
  const Hdf5Handle space(H5Dget_space(dataset_.id()), H5Sclose);
  std::array<hsize_t, 2> size{1, 1};
  dimensions_ = H5Sget_simple_extent_ndims(space.id());
  if ((dimensions_ != 1 && dimensions_ != 2) ||
      H5Sget_simple_extent_dims(space.id(), size.data(), nullptr) < 0) {
    return;
  }
  rows_ = dimensions_ == 2 ? size[0] : 1;
  if (rows_ > 0 && rows_ <= max_rows) {
    columns_ = dimensions_ == 2 ? size[1] : size[0];
  }
}

const void* Hdf5Window::find(std::uint64_t first, std::uint64_t count, std::uint64_t row) {
  if (!columns_ || first > *columns_ || count > *columns_ - first) {
    return nullptr;
  }
  if ((first < first_ || first + count > first_ + count_) &&
      !read(first, std::min(*columns_ - first, std::max(count, stretch_columns)))) {
    return nullptr;
  }
  return stretch_.data() + (row * count_ + (first - first_)) * element_bytes_;
}

bool Hdf5Window::read(std::uint64_t first, std::uint64_t count) {
  count_ = 0;
  if (count > max_stretch_bytes / element_bytes_ / rows_) {
    return false;
  }
  stretch_.resize(std::max<std::size_t>(1, count * rows_ * element_bytes_));
  const std::array<hsize_t, 2> start{0, first};
  const std::array<hsize_t, 2> size{rows_, count};
  const std::size_t skipped = dimensions_ == 2 ? 0 : 1;
  const Hdf5Handle space(H5Dget_space(dataset_.id()), H5Sclose);
  const Hdf5Handle memory(H5Screate_simple(dimensions_, size.data() + skipped, nullptr), H5Sclose);
  if (count > 0 && (H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data() + skipped, nullptr,
                                        size.data() + skipped, nullptr) < 0 ||
                    H5Dread(dataset_.id(), type_.id(), memory.id(), space.id(), H5P_DEFAULT,
                            stretch_.data()) < 0)) {
    return false;
  }
  first_ = first;
  count_ = count;
  return true;
}

} // namespace dyncal::services

#endif
