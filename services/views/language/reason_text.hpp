// Reasons that programs give in English alone (why a run paused or ended early, why a step has no
// value), in the languages of documents: in another language the document says where the reason
// stands. Plain functions, any thread.
#pragma once

#include <string>

#include "services/views/language/language.hpp"

namespace dyncal::inline views {

// Of what the result file has.
[[nodiscard]] std::string reason_text(Language language, const std::string& english);

} // namespace dyncal::inline views
