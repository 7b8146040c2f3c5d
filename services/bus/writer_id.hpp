// Which DDS writer a message came from: the GUID of the writer. Its first 12 bytes are those of the
// writer's participant, that is of the program, which no other one on the network has. A program
// that makes its own packets can copy them; one that uses a DDS library cannot.
//
// Unknown (zeros) where the vendor does not tell, as one may not of a writer that was gone before
// its message was taken. Plain data.
#pragma once

#include <array>
#include <string>

#include "services/bus/discovery.hpp"

namespace dyncal::bus {

struct WriterId {
  std::array<unsigned char, 16> guid{};

  [[nodiscard]] bool is_known() const { return *this != WriterId{}; }
  // Its participant's `id`, as in discovery.hpp; empty where it is not known.
  [[nodiscard]] std::string participant() const {
    return is_known() ? hexadecimal(guid.data(), guid_prefix_bytes) : "";
  }

  friend bool operator==(const WriterId&, const WriterId&) = default;
};

} // namespace dyncal::bus
