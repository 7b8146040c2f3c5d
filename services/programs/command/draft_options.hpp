// Which option of `dyncal new-bench` gives a key of the bench file that it drafts, so that what is
// said of the file that nobody has seen yet names what was typed. Plain functions, any thread.
#pragma once

#include <optional>
#include <string>

#include "services/bench/draft/bench_draft.hpp"

namespace dyncal::inline programs {

// "--level" for "excitation.level"; nothing: no option does.
[[nodiscard]] std::optional<std::string> option_of(const bench_draft::BenchDraft& draft,
                                                   const std::string& key);

// "--level (excitation.level) must be positive" of the key and "must be positive"; keys within the
// sentence get their options, too. "key 'generator.levl' is not known" where no option gives it.
[[nodiscard]] std::string sentence_with_options(const bench_draft::BenchDraft& draft,
                                                const std::string& key, std::string sentence);

} // namespace dyncal::inline programs
