// Makes the TypeSupport of a struct that fastddsgen generated. Only type_support.cpp and tests with
// types of their own need it.
//
// A struct whose last member is `checksum` gets one when it is written. When it is read, a wrong
// one is an error; then the member is 0, so that a message is equal to the one that was written.
//
// Fast CDR makes room for as many elements as a sequence says, if only that many bytes are left: of
// structs a hundred times the length of the message, and a changed message would be refused after
// it. So what is longer than `max_unchecked_bytes` is read only if it ends with its checksum.
//
// Errors of Fast CDR, which throws, end here.
#pragma once

#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>

#include "services/bus/cdr_key.hpp"
#include "services/bus/payload_checksum.hpp"
#include "services/bus/qos_profiles.hpp"
#include "services/bus/type_support.hpp"

namespace dyncal::bus {

template <class T>
concept HasChecksum = requires(T sample) {
  sample.checksum();
};

// Bytes of the members that were appended to a topic's type since its first release, when they are
// empty: only these may be missing in a message. A type that grows more has one of its own.
template <class T>
inline constexpr std::size_t appended_bytes = HasChecksum<T> ? checksum_bytes : 0;

// More than messages of the first release and of other tools need that give no checksum.
template <class T>
inline constexpr std::size_t max_unchecked_bytes = std::size_t{256} << 10U;
// Their sequences are of numbers, of which each takes no more than eight bytes of room.
template <>
inline constexpr std::size_t max_unchecked_bytes<wire::SampleBlock> = max_sample_bytes;
template <>
inline constexpr std::size_t max_unchecked_bytes<wire::TriggeredRecord> = max_sample_bytes;

template <class T>
struct Encoder {
  static void* create() { return new T(); }
  static void destroy(void* sample) { delete static_cast<T*>(sample); }

  static std::size_t serialized_size(const void* sample) {
    return cdr_header_bytes + T::getCdrSerializedSize(*static_cast<const T*>(sample));
  }

  static std::size_t serialize(const void* sample, char* bytes, std::size_t capacity) {
    const std::size_t count = write(bytes, capacity, [sample](Cdr& cdr) {
      cdr.serialize_encapsulation();
      static_cast<const T*>(sample)->serialize(cdr);
    });
    if constexpr (HasChecksum<T>) {
      if (count > 0) {
        set_checksum(bytes, count);
      }
    }
    return count;
  }

  static bool deserialize(void* sample, const char* bytes, std::size_t count) {
    if (count < cdr_header_bytes ||
        (count > max_unchecked_bytes<T> && !ends_with_checksum(bytes, count))) {
      return false;
    }
    auto& members = *static_cast<T*>(sample);
    const auto [understood, is_whole] = read(members, bytes, count);
    if (is_whole) {
      return take_checksum(members, bytes, understood);
    }
    // Fast CDR stops at the beginning of the first member that is not wholly there. Only when the
    // message ends just before it (but for padding to 4 bytes) it comes from a program whose type
    // has fewer members; otherwise it is damaged.
    if (count - understood >= 4) {
      return false;
    }
    // Zeros read as 0, "" and empty.
    std::vector<char> extended(((understood + 3U) & ~std::size_t{3}) + appended_bytes<T>, '\0');
    std::memcpy(extended.data(), bytes, understood);
    return read(members, extended.data(), extended.size()).is_whole;
  }

private:
  using Cdr = eprosima::fastcdr::Cdr;

  struct Read {
    std::size_t bytes = 0; // before the first member that could not be read
    bool is_whole = false;
  };

  template <class Serialize>
  static std::size_t write(char* bytes, std::size_t capacity, Serialize&& serialize_members) {
    try {
      eprosima::fastcdr::FastBuffer buffer(bytes, capacity);
      Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
      serialize_members(cdr);
      return cdr.getSerializedDataLength();
    } catch (const std::exception&) {
      return 0;
    }
  }

  // Returns false if there is one and it is wrong.
  static bool take_checksum(T& sample, const char* bytes, std::size_t end) {
    if constexpr (HasChecksum<T>) {
      const std::uint32_t given = sample.checksum();
      sample.checksum(0);
      return given == 0 || given == payload_checksum(bytes, end - checksum_bytes);
    }
    return true;
  }

  static Read read(T& sample, const char* bytes, std::size_t count) {
    // FastBuffer wants a mutable pointer; nothing is written through it here.
    eprosima::fastcdr::FastBuffer buffer(const_cast<char*>(bytes), count);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    try {
      cdr.read_encapsulation();
      sample.deserialize(cdr);
      return {cdr.getSerializedDataLength(), true};
    } catch (const std::exception&) {
      return {cdr.getSerializedDataLength(), false};
    }
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
