// Text as it stands in the elements and quoted attributes of SVG and HTML, so that no name in a
// file becomes markup. Characters that XML does not allow, and bytes that are not UTF-8, become
// U+FFFD. Any thread.
#pragma once

#include <string>
#include <string_view>

namespace dyncal::services {

[[nodiscard]] std::string escaped(std::string_view text);

} // namespace dyncal::services
