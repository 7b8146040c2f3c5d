// Asks a generator who it is, and nothing else: its settings and its output stay as they are.
//
// Takes at most a few seconds. Fails as ScpiConnection does. Any thread.
#pragma once

#include <string>

#include "drivers/error.hpp"

namespace dyncal::drivers::generator {

// The answer to *IDN?
[[nodiscard]] Expected<std::string> read_identity(const std::string& address);

} // namespace dyncal::drivers::generator
