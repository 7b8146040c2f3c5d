// Rows of an uncertainty budget in the words of ISO 16063-11 and -21, annex A: what of which
// instrument. Names that a reference file gives its contributions stay as they are. Any thread.
#pragma once

#include <string>
#include <string_view>

#include "analysis/uncertainty/contribution.hpp"
#include "services/views/language/language.hpp"

namespace dyncal::inline views {

// "reference transducer, noise"
[[nodiscard]] std::string contribution_name(const analysis::Contribution& row, Language language);

[[nodiscard]] std::string_view name_of(analysis::Distribution distribution, Language language);
// How often it is drawn: "in each repetition".
[[nodiscard]] std::string_view name_of(analysis::Repeats repeats, Language language);

} // namespace dyncal::inline views
