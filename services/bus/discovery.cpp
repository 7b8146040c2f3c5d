#include "services/bus/discovery.hpp"

#include <array>
#include <utility>

namespace dyncal::bus {

std::string vendor_of(const std::string& id) {
  // As the OMG has given them out.
  static constexpr std::array<std::pair<const char*, const char*>, 7> vendors{
      {{"010f", "Fast DDS"},
       {"0110", "Cyclone DDS"},
       {"0101", "RTI Connext"},
       {"0102", "OpenSplice"},
       {"0103", "OpenDDS"},
       {"0106", "CoreDX"},
       {"0112", "RustDDS"}}};
  const std::string number = id.substr(0, 4);
  for (const auto& [known, name] : vendors) {
    if (number == known) {
      return name;
    }
  }
  return "vendor " + number;
}

std::string hexadecimal(const unsigned char* bytes, std::size_t count) {
  constexpr const char* digits = "0123456789abcdef";
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text += digits[bytes[i] >> 4U];
    text += digits[bytes[i] & 0x0FU];
  }
  return text;
}

} // namespace dyncal::bus
