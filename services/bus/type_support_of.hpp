// Makes the TypeSupport of a struct that fastddsgen generated. Only type_support.cpp and tests with
// types of their own need it.
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
#include "services/bus/type_support.hpp"

namespace dyncal::bus {

template <class T>
struct Encoder {
  static void* create() { return new T(); }
  static void destroy(void* sample) { delete static_cast<T*>(sample); }

  static std::size_t serialized_size(const void* sample) {
    return cdr_header_bytes + T::getCdrSerializedSize(*static_cast<const T*>(sample));
  }

  static std::size_t serialize(const void* sample, char* bytes, std::size_t capacity) {
    return write(bytes, capacity, Cdr::LITTLE_ENDIANNESS, [sample](Cdr& cdr) {
      cdr.serialize_encapsulation();
      static_cast<const T*>(sample)->serialize(cdr);
    });
  }

  static std::size_t serialize_key(const void* sample, char* bytes, std::size_t capacity) {
    return write(bytes, capacity, Cdr::LITTLE_ENDIANNESS, [sample](Cdr& cdr) {
      cdr.serialize_encapsulation();
      static_cast<const T*>(sample)->serializeKey(cdr);
    });
  }

  static std::size_t canonical_key(const void* sample, char* bytes, std::size_t capacity) {
    std::memset(bytes, 0, capacity); // Fast CDR leaves padding as it is
    return write(bytes, capacity, Cdr::BIG_ENDIANNESS,
                 [sample](Cdr& cdr) { static_cast<const T*>(sample)->serializeKey(cdr); });
  }

  static bool deserialize(void* sample, const char* bytes, std::size_t count) {
    if (count < cdr_header_bytes) {
      return false;
    }
    const std::size_t understood = read(sample, bytes, count);
    if (understood == everything) {
      return true;
    }
    // Fast CDR stops at the beginning of the first member that is not wholly there. Only when the
    // message ends just before it (but for padding to 4 bytes) it comes from a program whose type
    // has fewer members; otherwise it is damaged.
    if (count - understood >= 4) {
      return false;
    }
    // Zeros read as 0, "" and empty; no struct of the contract is longer than this when all its
    // members are empty.
    constexpr std::size_t zeros = 1024;
    std::vector<char> extended(understood + zeros, '\0');
    std::memcpy(extended.data(), bytes, understood);
    return read(sample, extended.data(), extended.size()) == everything;
  }

private:
  using Cdr = eprosima::fastcdr::Cdr;

  static constexpr std::size_t everything = static_cast<std::size_t>(-1);

  template <class Serialize>
  static std::size_t write(char* bytes, std::size_t capacity, Cdr::Endianness byte_order,
                           Serialize&& serialize_members) {
    try {
      eprosima::fastcdr::FastBuffer buffer(bytes, capacity);
      Cdr cdr(buffer, byte_order, Cdr::DDS_CDR);
      serialize_members(cdr);
      return cdr.getSerializedDataLength();
    } catch (const std::exception&) {
      return 0;
    }
  }

  // Returns `everything`, or the number of bytes before the first member that could not be read.
  static std::size_t read(void* sample, const char* bytes, std::size_t count) {
    // FastBuffer wants a mutable pointer; nothing is written through it here.
    eprosima::fastcdr::FastBuffer buffer(const_cast<char*>(bytes), count);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    try {
      cdr.read_encapsulation();
      static_cast<T*>(sample)->deserialize(cdr);
      return everything;
    } catch (const std::exception&) {
      return cdr.getSerializedDataLength();
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
                     &Encoder<T>::serialize_key,
                     &Encoder<T>::canonical_key,
                     &Encoder<T>::deserialize};
}

} // namespace dyncal::bus
