// What people call error bars, on a command line and in an address of the page. Plain function, any
// thread.
#pragma once

#include <optional>
#include <string_view>

#include "services/views/figures/transfer_function.hpp"

namespace dyncal::inline views::figures {

// "standard" or "u", "expanded" or "U", "none"; nothing: it is none of these.
[[nodiscard]] inline std::optional<ErrorBars> parse_error_bars(std::string_view name) {
  if (name == "standard" || name == "u") {
    return ErrorBars::standard;
  }
  if (name == "expanded" || name == "U") {
    return ErrorBars::expanded;
  }
  return name == "none" ? std::optional(ErrorBars::none) : std::nullopt;
}

} // namespace dyncal::inline views::figures
