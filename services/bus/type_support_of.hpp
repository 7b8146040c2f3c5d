// Makes the TypeSupport of a struct of the contract. Only type_support.cpp and tests with types of
// their own need it.
//
// A struct whose last member is `checksum`, or `checksum_3` where contract 3 has appended members,
// gets one when it is written. When it is read, a wrong one is an error; then the member is 0, so
// that a message is equal to the one that was written.
#pragma once

#include <string>
#include <vector>

#include "services/bus/cdr_reader.hpp"
#include "services/bus/cdr_writer.hpp"
#include "services/bus/payload_checksum.hpp"
#include "services/bus/type_support.hpp"

namespace dyncal::bus {

template <class T>
concept HasChecksum = requires(T sample) {
  sample.checksum();
};

template <class T>
concept HasChecksumOfContract3 = requires(T sample) {
  sample.checksum_3();
};

// Bytes of the members that were appended to a topic's type since its first release, when they are
// empty: only these may be missing in a message. A type that grows more has one of its own.
template <class T>
inline constexpr std::size_t appended_bytes = HasChecksumOfContract3<T> ? 128
                                              : HasChecksum<T>          ? checksum_bytes
                                                                        : 0;

template <class T>
struct Encoder {
  static void* create() { return new T(); }
  static void destroy(void* sample) { delete static_cast<T*>(sample); }

  static std::size_t serialized_size(const void* sample) {
    CdrWriter counter;
    counter(*static_cast<const T*>(sample));
    return counter.size();
  }

  static std::size_t serialize(const void* sample, char* bytes, std::size_t capacity) {
    CdrWriter writer(bytes, capacity);
    writer(*static_cast<const T*>(sample));
    if (!writer.fits()) {
      return 0;
    }
    bytes[1] = 1; // plain CDR, little-endian
    if constexpr (HasChecksum<T>) {
      set_checksum(bytes, writer.size());
    }
    return writer.size();
  }

  static bool deserialize(void* sample, const char* bytes, std::size_t count) {
    if (count < cdr_header_bytes) {
      return false;
    }
    auto& members = *static_cast<T*>(sample);
    CdrReader reader(bytes, count);
    reader(members);
    if (reader.is_whole()) {
      return take_checksum(members, bytes, reader.size());
    }
    // Only when the message ends just before the first member that is not wholly there (but for
    // padding to 4 bytes) it comes from a program whose type has fewer members; otherwise it is
    // damaged.
    const std::size_t understood = reader.size();
    if (count - understood >= 4 || !take_older_checksum(members, bytes, understood)) {
      return false;
    }
    // Zeros read as 0, "" and empty.
    std::vector<char> extended(((understood + 3U) & ~std::size_t{3}) + appended_bytes<T>, '\0');
    std::copy_n(bytes, understood, extended.data());
    CdrReader extended_reader(extended.data(), extended.size());
    extended_reader(members);
    if constexpr (HasChecksumOfContract3<T>) {
      members.checksum(0);
    }
    return extended_reader.is_whole();
  }

private:
  // Returns false if there is one and it is wrong.
  static bool take_checksum(T& sample, const char* bytes, std::size_t end) {
    if constexpr (HasChecksumOfContract3<T>) {
      const std::uint32_t given = sample.checksum_3();
      sample.checksum_3(0);
      return is_right(given, bytes, end);
    } else if constexpr (HasChecksum<T>) {
      const std::uint32_t given = sample.checksum();
      sample.checksum(0);
      return is_right(given, bytes, end);
    }
    return true;
  }
  // Of a message that may have ended with it before contract 3.
  static bool take_older_checksum(T& sample, const char* bytes, std::size_t end) {
    if constexpr (HasChecksumOfContract3<T>) {
      const std::uint32_t given = sample.checksum();
      sample.checksum(0);
      return is_right(given, bytes, end);
    }
    return true;
  }
  static bool is_right(std::uint32_t given, const char* bytes, std::size_t end) {
    return given == 0 || given == payload_checksum(bytes, end - checksum_bytes);
  }
};

template <class T>
[[nodiscard]] TypeSupport make_type_support(const std::string& name, const KeyLayout& key) {
  return TypeSupport{name,
                     key,
                     &Encoder<T>::create,
                     &Encoder<T>::destroy,
                     &Encoder<T>::serialized_size,
                     &Encoder<T>::serialize,
                     &Encoder<T>::deserialize};
}

} // namespace dyncal::bus
