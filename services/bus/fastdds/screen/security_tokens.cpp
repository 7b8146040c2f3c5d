#include "services/bus/fastdds/screen/security_tokens.hpp"

#include <algorithm>
#include <array>

namespace dyncal::bus {

using namespace rtps_format;

namespace {

// Identity, permissions, status of the identity.
constexpr std::array<std::uint16_t, 3> tokens{0x1001, 0x1002, 0x1006};

// What of a message has not been passed yet. Everything in it is aligned to four bytes.
class Rest {
public:
  Rest(Bytes bytes, unsigned char flags) : bytes_(bytes), flags_(flags) {}

  [[nodiscard]] bool pass(std::size_t count) {
    const std::size_t padded = (count + 3U) & ~std::size_t{3};
    if (count > bytes_.size()) {
      return false;
    }
    bytes_ = bytes_.subspan(std::min(padded, bytes_.size()));
    return true;
  }
  // A string, or bytes, behind the count of them.
  [[nodiscard]] bool pass_counted() {
    const auto count = take_count();
    return count && pass(*count);
  }
  // As many of these as the count says.
  template <class Pass>
  [[nodiscard]] bool pass_each(Pass&& pass_one) {
    const auto count = take_count();
    bool whole = count.has_value();
    for (std::uint32_t i = 0; whole && i < *count; ++i) {
      whole = pass_one();
    }
    return whole;
  }
  [[nodiscard]] bool pass_data_holder() {
    const auto pass_property = [this] { return pass_counted() && pass_counted(); };
    return pass_counted() && pass_each(pass_property) && pass_each(pass_property);
  }

private:
  std::optional<std::uint32_t> take_count() {
    if (bytes_.size() < sizeof(std::uint32_t)) {
      return std::nullopt;
    }
    const auto count = number_at<std::uint32_t>(bytes_, 0, flags_);
    bytes_ = bytes_.subspan(sizeof count);
    return count;
  }

  Bytes bytes_;
  unsigned char flags_;
};

} // namespace

bool is_security_token(std::uint16_t parameter) {
  return std::ranges::find(tokens, parameter) != tokens.end();
}

bool token_is_whole(Bytes value, unsigned char flags) {
  return Rest(value, flags).pass_data_holder();
}

bool handshake_is_whole(Bytes payload) {
  constexpr std::size_t encapsulation_bytes = 4;
  constexpr std::size_t guid_bytes = prefix_bytes + entity_bytes;
  // Identities of this message and the one that it answers, then who it is for and from.
  constexpr std::size_t before_class = 2 * (guid_bytes + sequence_bytes) + 3 * guid_bytes;
  if (payload.size() < encapsulation_bytes || payload[0] != 0 || payload[1] > 1) {
    return false;
  }
  Rest rest(payload.subspan(encapsulation_bytes), payload[1]); // 1: little endian
  return rest.pass(before_class) && rest.pass_counted() &&
         rest.pass_each([&] { return rest.pass_data_holder(); });
}

} // namespace dyncal::bus
