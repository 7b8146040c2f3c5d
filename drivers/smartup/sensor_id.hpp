// Identifiers of sensors as the SmartUp Unit makes them: checksum of the board << 16 | sensor
// number << 8 | settings.
#pragma once

#include <cstdint>
#include <string>

namespace dyncal::drivers::smartup {

// "0xbccb0100"
[[nodiscard]] inline std::string sensor_text(std::uint32_t sensor) {
  constexpr const char* digits = "0123456789abcdef";
  std::string text = "0x";
  for (int shift = 28; shift >= 0; shift -= 4) {
    text += digits[(sensor >> static_cast<unsigned>(shift)) & 0xFU];
  }
  return text;
}

} // namespace dyncal::drivers::smartup
