// Counts packets that never became a message, because they are not RTPS or not as they should be,
// and tells the user of the first one.
//
// No program of a laboratory sends such packets: they come from port scanners, from other programs
// at the ports of DDS, from broken hardware, or from someone who means harm. Any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace dyncal::bus {

class RefusedPackets {
public:
  // `warn` may be empty; it is called from the vendor's threads.
  explicit RefusedPackets(std::function<void(const std::string&)> warn) : warn_(std::move(warn)) {}

  // From the address in a locator of RTPS (DDSI-RTPS 9.3.2): IPv4 is its end.
  [[nodiscard]] static std::uint32_t sender_in(std::span<const unsigned char, 16> locator_address);

  // `sender` is an IPv4 address, the first byte uppermost; 0 if it is not known.
  void add(std::uint32_t sender);
  // A packet that is RTPS, but does not go on from those before (message_check.hpp).
  // Some do not after a link was down: so they count from the one behind `many_implausible` on.
  void add_implausible(std::uint32_t sender);
  static constexpr std::uint64_t many_implausible = 1000;
  [[nodiscard]] std::uint64_t count() const { return count_; }
  // "10.0.0.7"; empty if it is not known.
  [[nodiscard]] std::string last_sender() const;

private:
  void count(std::uint32_t sender, const char* kind);

  std::function<void(const std::string&)> warn_;
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::uint64_t> implausible_{0};
  std::atomic<std::uint32_t> last_sender_{0};
};

} // namespace dyncal::bus
