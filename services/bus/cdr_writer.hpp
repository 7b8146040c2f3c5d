// Writes members of a message as plain CDR (XCDR1), little-endian: numbers are aligned to their
// size, counted from behind the encapsulation header; a string is its length with the closing zero,
// then its characters; a sequence is its count, then its elements.
//
// Writes into room that is zero, because padding stays as it is. Without room it only counts.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "idl/bounded_string.hpp"
#include "services/bus/cdr_key.hpp"

namespace dyncal::bus {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie here");

class CdrWriter {
public:
  CdrWriter() = default; // counts
  CdrWriter(char* bytes, std::size_t capacity) : bytes_(bytes), capacity_(capacity) {}

  // Of the whole payload, with its header.
  [[nodiscard]] std::size_t size() const { return cdr_header_bytes + position_; }
  [[nodiscard]] bool fits() const { return bytes_ == nullptr || size() <= capacity_; }

  template <class T>
  void operator()(const T& member) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      align(sizeof member);
      put(&member, sizeof member);
    } else {
      T::visit_members(member, *this);
    }
  }
  template <std::size_t bound>
  void operator()(const wire::BoundedString<bound>& text) {
    put_text(text.c_str(), text.size());
  }
  // To its first zero: what is behind it has no place in a string of DDS.
  void operator()(const std::string& text) { put_text(text.c_str(), std::strlen(text.c_str())); }
  template <class T>
  void operator()(const std::vector<T>& elements) {
    (*this)(static_cast<std::uint32_t>(elements.size()));
    if constexpr (std::is_arithmetic_v<T>) {
      if (!elements.empty()) {
        align(sizeof(T));
        put(elements.data(), elements.size() * sizeof(T));
      }
    } else {
      for (const T& element : elements) {
        (*this)(element);
      }
    }
  }

private:
  void align(std::size_t to) { position_ = (position_ + to - 1) & ~(to - 1); }

  void put(const void* from, std::size_t count) {
    const std::size_t begin = size();
    position_ += count;
    if (bytes_ != nullptr && fits()) {
      std::memcpy(bytes_ + begin, from, count);
    }
  }

  void put_text(const char* text, std::size_t count) {
    (*this)(static_cast<std::uint32_t>(count + 1));
    put(text, count + 1);
  }

  char* bytes_ = nullptr;
  std::size_t capacity_ = 0;
  std::size_t position_ = 0; // behind the header
};

} // namespace dyncal::bus
