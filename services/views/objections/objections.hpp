// What speaks against a certificate of a stored run: values that are missing, losses that nothing
// explains, flags that forbid it (refusing_flags.hpp), a run that was broken off. Each objection is
// a sentence that a person understands without the result file: it goes into a certificate that is
// forced in spite of it. What evaluation and conductor said in English alone, is in another
// language said by what is known of it beside the sentence, else the result file is named, which
// has it. Plain functions, any thread.
#pragma once

#include <string>
#include <vector>

#include "services/views/language/sentence.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

// Of these channels; none: the run may be certified.
[[nodiscard]] std::vector<TranslatedText> objections_to(const StoredResult& result,
                                                        const std::vector<std::string>& channels);

// What must hold over the run and does not, in these channels.
[[nodiscard]] std::vector<TranslatedText>
open_closures_of(const StoredResult& result, const std::vector<std::string>& channels);

// REQUIRES: the point is not valid.
[[nodiscard]] TranslatedText why_without_value(const StoredPoint& point);

// Flags of these channels that do not forbid a certificate, with what to state of them.
[[nodiscard]] std::vector<TranslatedText> stated_flags(const StoredResult& result,
                                                       const std::vector<std::string>& channels);

} // namespace dyncal::inline views
