#include "services/bus/cdr_key.hpp"

#include <bit>
#include <cstring>

#include "services/bus/type_support.hpp"

namespace dyncal::bus {
namespace {

static_assert(std::endian::native == std::endian::little,
              "byte orders below are written for little-endian machines");

// Reads CDR members behind the header; alignment counts from there.
class KeyReader {
public:
  KeyReader(const char* payload, std::size_t count, bool swap)
      : payload_(payload), count_(count), swap_(swap) {}

  std::optional<std::uint32_t> number() {
    const std::size_t begin = (position_ + 3U) & ~std::size_t{3};
    if (begin + sizeof(std::uint32_t) > count_) {
      return std::nullopt;
    }
    std::uint32_t value = 0;
    std::memcpy(&value, payload_ + begin, sizeof value);
    position_ = begin + sizeof value;
    return swap_ ? __builtin_bswap32(value) : value;
  }

  // A string travels as its length with the closing zero, then its characters and the zero.
  std::optional<std::string> string(std::size_t bound) {
    const auto length = number();
    if (!length || *length == 0 || *length > bound + 1 || *length > count_ - position_) {
      return std::nullopt;
    }
    const char* begin = payload_ + position_;
    position_ += *length;
    if (begin[*length - 1] != '\0') {
      return std::nullopt;
    }
    return std::string(begin, *length - 1);
  }

private:
  const char* payload_;
  std::size_t count_;
  bool swap_;
  std::size_t position_ = 0;
};

void append_number(std::string& bytes, std::uint32_t value, ByteOrder order) {
  bytes.resize((bytes.size() + 3U) & ~std::size_t{3}, '\0');
  if (order == ByteOrder::big) {
    value = __builtin_bswap32(value);
  }
  char encoded[sizeof value];
  std::memcpy(encoded, &value, sizeof value);
  bytes.append(encoded, sizeof value);
}

std::string encode(const Key& key, ByteOrder order) {
  std::string bytes;
  for (const std::string& text : key.strings) {
    append_number(bytes, static_cast<std::uint32_t>(text.size() + 1), order);
    bytes.append(text.c_str(), text.size() + 1);
  }
  for (const std::uint32_t value : key.numbers) {
    append_number(bytes, value, order);
  }
  return bytes;
}

} // namespace

std::optional<Key> read_key(const KeyLayout& layout, const char* bytes, std::size_t count) {
  // Representation 0 is plain CDR in big-endian, 1 in little-endian.
  if (count < cdr_header_bytes || bytes[0] != 0 || (bytes[1] != 0 && bytes[1] != 1)) {
    return std::nullopt;
  }
  KeyReader reader(bytes + cdr_header_bytes, count - cdr_header_bytes, bytes[1] == 0);
  Key key;
  for (const std::size_t bound : layout.string_bounds) {
    auto text = reader.string(bound);
    if (!text) {
      return std::nullopt;
    }
    key.strings.push_back(std::move(*text));
  }
  for (std::size_t i = 0; i < layout.numbers; ++i) {
    const auto value = reader.number();
    if (!value) {
      return std::nullopt;
    }
    key.numbers.push_back(*value);
  }
  return key;
}

std::string key_payload(const Key& key, ByteOrder order) {
  const char header[cdr_header_bytes] = {0, order == ByteOrder::little ? char{1} : char{0}, 0, 0};
  return std::string(header, cdr_header_bytes) + encode(key, order);
}

std::string canonical_key(const Key& key) {
  return encode(key, ByteOrder::big);
}

} // namespace dyncal::bus
