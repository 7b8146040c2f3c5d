// HDF5 files with any datasets, types, sizes and attributes where the SmartUp receiver has its own:
// they are read or refused with their name, and no block's sizes contradict each other.
//
// The bytes choose what the library writes, for damage below that is the library's to find; a file
// of dyncal that was changed never gets that far (hdf5_library.hpp).
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include "drivers/files/hdf5_reader.hpp"
#include "drivers/link/file_descriptor.hpp"

namespace {

using namespace dyncal::drivers;
using files::Hdf5Handle;

class Choices {
public:
  Choices(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  std::uint8_t next(std::uint8_t below) {
    const std::uint8_t value = size_ == 0 ? 0 : *data_;
    data_ += size_ == 0 ? 0 : 1;
    size_ -= size_ == 0 ? 0 : 1;
    return static_cast<std::uint8_t>(value % below);
  }

private:
  const std::uint8_t* data_;
  std::size_t size_;
};

hid_t type_of(std::uint8_t choice) {
  const std::array types{H5T_NATIVE_UINT64, H5T_NATIVE_UINT32, H5T_NATIVE_FLOAT, H5T_NATIVE_DOUBLE,
                         H5T_NATIVE_INT8,   H5T_C_S1,          H5T_NATIVE_INT64};
  return types[choice % types.size()];
}

void add_attribute(hid_t object, Choices& choices) {
  const std::array names{"Unit", "Resolution", "Min_scale", "Max_scale", "Coverage_factor"};
  const hid_t type = type_of(choices.next(7));
  const std::array<hsize_t, 1> size{choices.next(5)};
  const Hdf5Handle space(H5Screate_simple(1, size.data(), nullptr), H5Sclose);
  const Hdf5Handle attribute(
      H5Acreate2(object, names[choices.next(5)], type, space.id(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  std::array<std::uint8_t, 64> value{};
  value[0] = choices.next(255);
  value[6] = choices.next(255);
  if (attribute.is_open()) {
    H5Awrite(attribute.id(), type, value.data());
  }
}

// As the receiver has it, but for one of eight, which is anything.
void add_dataset(hid_t group, const std::string& name, std::uint8_t columns, Choices& choices) {
  const bool is_strange = choices.next(8) == 7;
  if (is_strange && choices.next(8) == 7) {
    const Hdf5Handle inner(H5Gcreate2(group, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                           H5Gclose);
    return;
  }
  const bool has_channels = name == "Acceleration" || name == "Voltage";
  hid_t type = name == "Absolutetime" ? H5T_NATIVE_UINT64 : H5T_NATIVE_UINT32;
  type = has_channels ? H5T_NATIVE_FLOAT : type;
  std::array<hsize_t, 3> size{has_channels ? 1U + choices.next(3) : 1U, columns, 1};
  int dimensions = 2;
  if (is_strange) {
    type = type_of(choices.next(7));
    size = {choices.next(4), choices.next(6), choices.next(3)};
    dimensions = choices.next(4);
  }
  const Hdf5Handle space(H5Screate_simple(dimensions, size.data(), nullptr), H5Sclose);
  const Hdf5Handle dataset(
      H5Dcreate2(group, name.c_str(), type, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose);
  if (!dataset.is_open()) {
    return;
  }
  std::array<std::uint8_t, 1024> values{};
  const std::size_t bytes = H5Tget_size(type);
  for (std::size_t i = 0; i < columns; ++i) { // rising, most of the time
    values[i * bytes] = static_cast<std::uint8_t>(i + 1 + (choices.next(16) == 15 ? 7 : 0));
    values[i * bytes + bytes - 1] = choices.next(32) == 31 ? choices.next(255) : 0;
  }
  H5Dwrite(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  while (choices.next(3) == 2) {
    add_attribute(dataset.id(), choices);
  }
}

void write_file(const std::string& path, Choices choices) {
  const files::Hdf5Lock lock;
  const Hdf5Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  const Hdf5Handle raw(H5Gcreate2(file.id(), "RAWDATA", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                       H5Gclose);
  const Hdf5Handle sensor(H5Gcreate2(raw.id(), "a", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                          H5Gclose);
  const std::uint8_t columns = static_cast<std::uint8_t>(choices.next(7) + 1);
  for (const char* name : {"Absolutetime", "Absolutetime_uncertainty", "Sample_number",
                           "Acceleration", "Voltage", "Stamp_flags"}) {
    if (choices.next(16) != 15) {
      add_dataset(sensor.id(), name, columns, choices);
    }
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FileDescriptor file(memfd_create("hdf5", MFD_CLOEXEC));
  files::FileSettings settings;
  settings.path = "/proc/self/fd/" + std::to_string(file.number());
  write_file(settings.path, Choices(data, size));
  const auto says_where = [&](const Error& error) {
    if (error.message.find(settings.path.string()) == std::string::npos) {
      std::abort();
    }
    return 0;
  };
  auto reader = files::Hdf5Reader::open(settings);
  if (!reader) {
    return says_where(reader.error());
  }
  const std::size_t channels = (*reader)->description().channels.size();
  for (;;) {
    const auto block = (*reader)->read(3);
    if (!block) {
      return says_where(block.error());
    }
    if (block->samples == 0) {
      return 0;
    }
    if (block->values.size() != block->samples * channels ||
        block->stamp_uncertainty_ns.size() != block->samples ||
        (!block->flags.empty() && block->flags.size() != block->samples) ||
        (!block->clock && block->stamps_ns.size() != block->samples)) {
      std::abort();
    }
  }
}
