// Findings about bench files, for people and for programs. Plain functions, any thread.
#pragma once

#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "services/base/finding.hpp"
#include "services/checks/bench_check/bench_view.hpp"

namespace dyncal::inline checks::bench_check {

// "FILE:LINE: error: key 'x' ...", one a line, and a last line with what came of all.
[[nodiscard]] std::string as_text(const Findings& findings);

// "status" (the gravest severity, "ok" without findings), "benches" (file, bench, sha256) and
// "findings" (severity, file, line, key, sentence).
[[nodiscard]] nlohmann::ordered_json as_json(const Findings& findings,
                                             std::span<const BenchView> views);

} // namespace dyncal::inline checks::bench_check
