// What everything that reads or writes HDF5 shares: handles that close themselves, one lock, and
// whether a file that dyncal has written is still as it was.
//
// The library may be used by one thread at a time: hold a Hdf5Lock as long as handles are used. It
// prints nothing of its own while one is held. A file that dyncal writes begins with a user block
// of 512 bytes, which other readers skip: a text that ends with the CRC-32 of everything behind
// it, so that no changed byte gets as far as the library. Files of others have no such text and are
// taken as they are.
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

inline constexpr std::uint64_t hdf5_user_block_bytes = 512;

// Writes the user block of a file that is complete and closed. `descriptor`: open for reading and
// writing. False: errno has the cause.
[[nodiscard]] bool seal_hdf5(int descriptor, const std::string& software);

// Opens for reading. Fails (not_found) when there is no such file, (malformed) when it is not HDF5,
// or is one of dyncal's that was changed since.
[[nodiscard]] Expected<Hdf5Handle> open_hdf5(const std::filesystem::path& path);

// Names of the members of a group, in alphabetical order; none if there is no such group.
[[nodiscard]] std::vector<std::string> hdf5_members(hid_t place, const std::string& group);

// The filter that the chunks of a dataset went through and that this library does not have, as
// "lzf (32000)"; "" if there is none.
[[nodiscard]] std::string hdf5_missing_filter(hid_t dataset);

// A text attribute of either kind of string; "" if there is none.
[[nodiscard]] std::string hdf5_text(hid_t object, const char* name);

} // namespace dyncal::drivers::files
