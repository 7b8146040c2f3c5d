// A TOML text without its comments, for readers who need what it sets and not how it was written.
// Lines that held nothing else go with them, and of several empty lines one stays. A # within a
// string is none; a text that is no TOML keeps its words. Any thread.
#pragma once

#include <string>
#include <string_view>

namespace dyncal::inline views {

[[nodiscard]] std::string without_comments(std::string_view toml);

} // namespace dyncal::inline views
