// Texts from the network on a terminal: without control characters, which could move the cursor or
// forge lines, and as wide as they seem. Plain functions, any thread.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace dyncal::inline programs {

// One line (printable_text.hpp), and '?' in place of letters that are not one column wide.
[[nodiscard]] std::string harmless(std::string_view text);

// The first `columns` of a text that harmless() made, with ".." at the end of what was longer;
// padded with blanks to the whole width.
[[nodiscard]] std::string in_columns(const std::string& text, std::size_t columns);

// How many columns a text that harmless() made takes.
[[nodiscard]] std::size_t columns_of(std::string_view text);

} // namespace dyncal::inline programs
