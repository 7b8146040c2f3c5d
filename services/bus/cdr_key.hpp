// The key of a message, read from and written to CDR without its type, by a KeyLayout.
//
// DDS identifies an instance by the MD5 of its key members in big-endian CDR (DDSI-RTPS 9.6.3.8).
// Vendors do this themselves for their own types; the bus needs it because it hands them bytes.
// Bounded strings are checked here: a foreign message whose key is longer than the contract allows
// is refused instead of being truncated to the name of somebody else.
//
// Pure functions, any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dyncal::bus {

struct KeyLayout;

inline constexpr std::size_t cdr_header_bytes =
    4; // encapsulation: representation (2 bytes, big-endian), options (2 bytes)

// No key of the contract is longer: three strings and two numbers.
inline constexpr std::size_t max_key_payload_bytes = 512;

struct Key {
  std::vector<std::string> strings;
  std::vector<std::uint32_t> numbers;
  bool operator==(const Key&) const = default;
};

using KeyHash = std::array<unsigned char, 16>;

// What DDS tells apart: a key, and the MD5 of its canonical form.
struct Instance {
  Key key;
  KeyHash hash{};
};

enum class ByteOrder { little, big };

// From a whole payload or one that ends after the key. Nothing when it is not plain CDR, ends too
// soon, or a string exceeds its bound.
[[nodiscard]] std::optional<Key> read_key(const KeyLayout& layout, const char* bytes,
                                          std::size_t count);

// Header and key members: the payload that announces the end of an instance.
[[nodiscard]] std::string key_payload(const Key& key, ByteOrder order);

// What MD5 is taken of: key members in big-endian CDR without header, padding zero.
[[nodiscard]] std::string canonical_key(const Key& key);

} // namespace dyncal::bus
