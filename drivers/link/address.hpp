// Where an instrument listens: host and port. Plain data; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "drivers/error.hpp"

namespace dyncal::drivers {

struct Address {
  std::string host;
  std::uint16_t port = 0;

  [[nodiscard]] std::string text() const { return host + ":" + std::to_string(port); }
};

// "127.0.0.1:5026", "localhost:5026", "[::1]:5026". Anything else is malformed.
[[nodiscard]] Expected<Address> parse_address(std::string_view text);

} // namespace dyncal::drivers
