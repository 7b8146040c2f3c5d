// The bench file of a draft, with comments that say what to look at, and the DBC file of a sensor
// on CAN that has none yet. Texts of the draft are quoted as TOML needs it, whatever they hold;
// what is not valid is found where the bench file is read. Plain functions, any thread.
#pragma once

#include <string>

#include "services/bench/draft/bench_draft.hpp"

namespace dyncal::inline bench::bench_draft {

// `dbc_name` is written where the draft names no DBC file.
[[nodiscard]] std::string bench_text(const BenchDraft& draft, const std::string& dbc_name);

// One message with three axes and a counter.
[[nodiscard]] std::string dbc_text();

} // namespace dyncal::inline bench::bench_draft
