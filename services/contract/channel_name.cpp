#include "services/contract/channel_name.hpp"

namespace dyncal::inline contract {

std::optional<ChannelName> parse_channel_name(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos || slash == 0 || slash + 1 == text.size() ||
      text.find('/', slash + 1) != std::string::npos) {
    return std::nullopt;
  }
  return ChannelName{text.substr(0, slash), text.substr(slash + 1)};
}

} // namespace dyncal::inline contract
