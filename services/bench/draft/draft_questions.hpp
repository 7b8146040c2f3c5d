// Asks for a draft, a question a line: what is asked, what may be answered, and what an empty line
// means. An answer that cannot be is asked for again. Belongs to one thread.
#pragma once

#include <functional>
#include <iosfwd>
#include <optional>
#include <string>

#include "services/base/error.hpp"
#include "services/bench/draft/bench_draft.hpp"

namespace dyncal::inline bench::bench_draft {

// Why a bench cannot have this name, for example because there is a file of it; nothing: it can.
using NameProblem = std::function<std::optional<std::string>(const std::string& name)>;

// `draft` gives what empty lines mean. Fails (interrupted) when the answers end early.
[[nodiscard]] Expected<BenchDraft> ask_for_draft(BenchDraft draft, const NameProblem& name_problem,
                                                 std::istream& answers, std::ostream& questions);

} // namespace dyncal::inline bench::bench_draft
