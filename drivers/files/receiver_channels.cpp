#include "drivers/files/receiver_channels.hpp"

#include <cctype>

namespace dyncal::drivers::files {

std::string receiver_channel(const std::string& group, std::size_t index, std::size_t members) {
  std::string name;
  for (const char c : group) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80 && std::isalnum(byte) != 0) {
      name += static_cast<char>(std::tolower(byte));
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') {
    name.pop_back();
  }
  if (members == 1) {
    return name;
  }
  return members == 3 && name != "voltage" ? name + "_" + "xyz"[index]
                                           : name + "_" + std::to_string(index);
}

std::uint32_t receiver_uncertainty_ns(std::uint32_t sent) {
  return sent / 4 + (sent % 4 != 0 ? 1 : 0);
}

void flag_receiver_stamps(SampleBlock& block) {
  for (std::size_t i = 0; i < block.samples; ++i) {
    unsigned flags = 0;
    if (block.stamp_uncertainty_ns[i] == 0) {
      flags |= stamp_no_uncertainty;
    }
    if (block.stamps_ns[i] == 0) {
      flags |= stamp_no_fix;
    }
    if (flags != 0) {
      block.flags.resize(block.samples);
      block.flags[i] = static_cast<std::uint8_t>(block.flags[i] | flags);
    }
  }
}

} // namespace dyncal::drivers::files
