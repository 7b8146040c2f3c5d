#include "services/bus/refused_packets.hpp"

namespace dyncal::bus {

void RefusedPackets::add(std::uint32_t sender) {
  last_sender_ = sender;
  if (count_++ > 0 || !warn_) {
    return;
  }
  const std::string from = last_sender();
  warn_("refused a malformed packet" + (from.empty() ? "" : " from " + from) +
        ", and will refuse others like it: let only your own programs send to the ports of DDS "
        "(`dyncal doctor` tells how many come)");
}

void RefusedPackets::add_implausible(std::uint32_t sender) {
  if (implausible_++ >= many_implausible) {
    add(sender);
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
