// How much waits in the UDP receive buffer of a port of this host, as the kernel reports it in
// /proc/net/udp and udp6.
//
// A real unit cannot know; the virtual bench, which may run far faster than real time, slows down
// instead of flooding a receiver that did not have the processor for a moment. Any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <string>

namespace dyncal::drivers::virtual_bench {

// Bytes, the fullest buffer where several sockets have the port; 0 when there is none or the kernel
// does not tell.
[[nodiscard]] std::size_t udp_receive_queue(std::uint16_t port);

// The same from a table in the kernel's form.
[[nodiscard]] std::size_t udp_receive_queue(std::istream& table, std::uint16_t port);

[[nodiscard]] bool is_loopback(const std::string& host);

} // namespace dyncal::drivers::virtual_bench
