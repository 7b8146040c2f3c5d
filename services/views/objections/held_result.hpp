// The result that a document is made of, with what shows that it is what was measured
// (services/records/provenance).
#pragma once

#include <vector>

#include "services/views/language/sentence.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

struct HeldResult {
  StoredResult result;
  std::vector<TranslatedText> statements{}; // for the document: what the result was held against
  std::vector<TranslatedText> objections{}; // why it may not be believed
};

} // namespace dyncal::inline views
