// What speaks against a certificate of a stored run: values that are missing, losses that nothing
// explains, flags that forbid it (refusing_flags.hpp), a run that was broken off. Each objection is
// a sentence that a person understands without the result file: it goes into a certificate that is
// forced in spite of it. Plain functions, any thread.
#pragma once

#include <string>
#include <vector>

#include "services/views/language/sentence.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

// Of these channels; none: the run may be certified.
[[nodiscard]] std::vector<std::string> objections_to(const StoredResult& result,
                                                     const std::vector<std::string>& channels);

// Flags of these channels that do not forbid a certificate, with what to state of them.
[[nodiscard]] std::vector<TranslatedText> stated_flags(const StoredResult& result,
                                                       const std::vector<std::string>& channels);

} // namespace dyncal::inline views
