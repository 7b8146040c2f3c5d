#include "services/live/limits.hpp"

namespace dyncal::services::live {

std::string bounded(std::string_view text) {
  if (text.size() <= max_text_bytes) {
    return std::string(text);
  }
  std::size_t end = max_text_bytes;
  const auto continues_letter = [&](std::size_t at) {
    return (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
  };
  while (end > 0 && continues_letter(end)) {
    --end;
  }
  return std::string(text.substr(0, end));
}

} // namespace dyncal::services::live
