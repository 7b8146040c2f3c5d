// The keys of [sources.NAME] with driver = "socket": the TCP stream of an analogue calibration
// system (drivers/acs/README.md).
//
//   address = "192.0.2.30:5026"
#pragma once

#include "services/bench/file/source_settings.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

[[nodiscard]] inline SocketSourceSettings read_socket_source(TomlTable& table) {
  return {.address = table.required_text("address")};
}

} // namespace dyncal::inline bench
