#include "services/bus/refused_packets.hpp"

namespace dyncal::bus {

std::uint32_t RefusedPackets::sender_in(std::span<const unsigned char, 16> locator_address) {
  const auto ipv4 = locator_address.last<4>();
  return std::uint32_t{ipv4[0]} << 24U | std::uint32_t{ipv4[1]} << 16U |
         std::uint32_t{ipv4[2]} << 8U | std::uint32_t{ipv4[3]};
}

void RefusedPackets::add(std::uint32_t sender) {
  count(sender, "malformed");
}

void RefusedPackets::count(std::uint32_t sender, const char* kind) {
  last_sender_ = sender;
  if (count_++ > 0 || !warn_) {
    return;
  }
  const std::string from = last_sender();
  warn_(std::string("refused a packet") + (from.empty() ? "" : " from " + from) + " that is " +
        kind +
        ", and will refuse others like it: let only your own programs send to the ports of DDS "
        "(`dyncal doctor` tells how many come)");
}

void RefusedPackets::add_implausible(std::uint32_t sender) {
  if (implausible_++ >= many_implausible) {
    count(sender, "implausible");
  }
}

std::string RefusedPackets::last_sender() const {
  const std::uint32_t address = last_sender_;
  if (address == 0) {
    return "";
  }
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) {
    text += (text.empty() ? "" : ".") + std::to_string(address >> shift & 0xffU);
  }
  return text;
}

} // namespace dyncal::bus
