// The checksum that every message of the contract ends with (idl/README.md, "Checksums").
//
// UDP's own has 16 bits, network cards and switches may set it again, and a packet that was changed
// and sent again has a right one. A changed byte in a sample or a result would be a wrong number
// that nobody sees. So the writer sums up the payload, and the reader drops a message whose sum is
// another one; what it lacks then is asked for like anything that was lost.
//
// CRC-32 as in ISO 3309 and zlib, over all bytes before the checksum, the encapsulation header
// among them. 0 says that the writer, another tool, gives none. Pure functions, any thread.
#pragma once

#include <cstddef>
#include <cstdint>

namespace dyncal::bus {

inline constexpr std::size_t checksum_bytes = 4; // at a multiple of 4 from the encapsulation header

// Never 0.
[[nodiscard]] std::uint32_t payload_checksum(const char* bytes, std::size_t count);

// Whether the payload's last bytes are the checksum of those before them, in the byte order that
// its encapsulation header names.
[[nodiscard]] bool ends_with_checksum(const char* payload, std::size_t count);

// Into the last bytes of a payload whose representation is little-endian. REQUIRES: they are
// there.
void set_checksum(char* payload, std::size_t count);

} // namespace dyncal::bus
