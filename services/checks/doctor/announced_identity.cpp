#include "services/checks/doctor/announced_identity.hpp"

#include <cstring>

namespace dyncal::inline checks::doctor {
namespace {

using namespace std::string_view_literals;

// A property of the identity token: its name and its value are texts with their lengths.
constexpr auto authority_name = "\x0a\0\0\0dds.ca.sn\0\0\0"sv;
constexpr std::size_t longest_subject = 512;
// PID_PARTICIPANT_SECURITY_INFO and its length.
constexpr auto protection_begin = "\x05\x10\x08\0"sv;
constexpr std::uint64_t both_valid = 0x8000'0000'8000'0000U;

template <class Number>
std::optional<Number> number_at(std::string_view packet, std::size_t at) {
  Number number{};
  if (at > packet.size() || packet.size() - at < sizeof number) {
    return std::nullopt;
  }
  std::memcpy(&number, packet.data() + at, sizeof number); // both are little-endian
  return number;
}

std::string authority_of(std::string_view packet) {
  const std::size_t found = packet.find(authority_name);
  if (found == std::string_view::npos) {
    return "";
  }
  const std::size_t at = found + authority_name.size();
  const auto length = number_at<std::uint32_t>(packet, at);
  if (!length || *length == 0 || *length > longest_subject ||
      packet.size() - at < sizeof *length + *length) {
    return "";
  }
  return std::string(packet.substr(at + sizeof *length, *length - 1));
}

} // namespace

AnnouncedIdentity identity_of_packet(std::string_view packet) {
  AnnouncedIdentity identity{authority_of(packet), std::nullopt};
  const std::size_t found = packet.find(protection_begin);
  if (found != std::string_view::npos) {
    const auto protection = number_at<std::uint64_t>(packet, found + protection_begin.size());
    if (protection && (*protection & both_valid) == both_valid) {
      identity.protection = protection;
    }
  }
  return identity;
}

} // namespace dyncal::inline checks::doctor
