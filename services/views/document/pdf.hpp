// A PDF of an HTML document that needs nothing else, by the program weasyprint (Debian package of
// that name) as a child process. The document refers to nothing outside itself, so weasyprint has
// nothing to fetch.
//
// Fails (bad_file) when weasyprint is not there, takes longer than two minutes, or ends with an
// error: the sentence has its last line. One thread at a time (it waits for a child).
#pragma once

#include <string>
#include <string_view>

#include "services/base/error.hpp"

namespace dyncal::inline views {

// The bytes of the PDF.
[[nodiscard]] Expected<std::string> make_pdf(std::string_view html);

} // namespace dyncal::inline views
