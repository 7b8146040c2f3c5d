#include "drivers/link/address.hpp"

#include <charconv>

namespace dyncal::drivers {

Expected<Address> parse_address(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  Address address;
  bool whole = colon != std::string_view::npos && colon > 0;
  if (whole) {
    const char* end = text.data() + text.size();
    const auto [rest, status] = std::from_chars(text.data() + colon + 1, end, address.port);
    whole = status == std::errc() && rest == end;
  }
  if (!whole) {
    return fail(ErrorCode::malformed,
                "\"" + std::string(text) +
                    "\" is not an address: write HOST:PORT, for example 127.0.0.1:5026");
  }
  std::string_view host = text.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  address.host = host;
  return address;
}

} // namespace dyncal::drivers
