// What everything that reads or writes HDF5 shares: handles that close themselves, and one lock.
//
// The library may be used by one thread at a time: hold a Hdf5Lock as long as handles are used. It
// prints nothing of its own while one is held.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <hdf5.h>

#include "drivers/error.hpp"

namespace dyncal::drivers::files {

class Hdf5Lock {
public:
  Hdf5Lock();
  ~Hdf5Lock();
  Hdf5Lock(const Hdf5Lock&) = delete;
  Hdf5Lock& operator=(const Hdf5Lock&) = delete;
};

class Hdf5Handle {
public:
  using Close = herr_t (*)(hid_t);
  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Close closing) : id_(id), close_(closing) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept;
  ~Hdf5Handle() { close(); }

  [[nodiscard]] hid_t id() const { return id_; }
  [[nodiscard]] bool is_open() const { return id_ >= 0; }
  // False: the library reports an error, such as a full disk.
  bool close();

private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

// Opens for reading. Fails (not_found) when there is no such file, (malformed) when it is not HDF5.
[[nodiscard]] Expected<Hdf5Handle> open_hdf5(const std::filesystem::path& path);

// Names of the members of a group, in alphabetical order; none if there is no such group.
[[nodiscard]] std::vector<std::string> hdf5_members(hid_t place, const std::string& group);

// The filter that the chunks of a dataset went through and that this library does not have, as
// "lzf (32000)"; "" if there is none.
[[nodiscard]] std::string hdf5_missing_filter(hid_t dataset);

// A text attribute of either kind of string; "" if there is none.
[[nodiscard]] std::string hdf5_text(hid_t object, const char* name);

} // namespace dyncal::drivers::files
