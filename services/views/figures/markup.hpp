// Text of others as it stands in documents. Any thread.
#pragma once

#include <string>
#include <string_view>

namespace dyncal::inline views {

// U+FFFD in place of bytes that are not UTF-8, of control characters but tab and line feed, which
// XML does not allow or a terminal obeys, and of letters that turn the order of a line, which would
// show another text than the one that was signed.
[[nodiscard]] std::string document_text(std::string_view text);

// The same, in the elements and quoted attributes of SVG and HTML, so that no name in a file
// becomes markup.
[[nodiscard]] std::string escaped(std::string_view text);

} // namespace dyncal::inline views
