// Text of DBC files in one encoding. Pure function; any thread.
#pragma once

#include <string>
#include <string_view>

namespace dyncal::drivers::can {

// UTF-8 as it is (without a byte order mark); anything else is taken for Windows-1252, whose five
// unassigned bytes become U+FFFD.
[[nodiscard]] std::string to_utf8(std::string_view text);

} // namespace dyncal::drivers::can
