// A running program of dyncal, as it names itself to others on the bus. Plain data.
#pragma once

#include <cstdint>
#include <string>

namespace dyncal::inline contract {

struct ProgramIdentity {
  std::string program; // "dyncal-acs"
  std::string host;
  std::uint32_t process_id = 0;
  std::string software; // name and version
  std::string dds;      // "fastdds" or "cyclonedds"
};

} // namespace dyncal::inline contract
