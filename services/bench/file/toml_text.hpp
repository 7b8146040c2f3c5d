// The text of a TOML file (1.0), parsed: what every file that a person writes goes through.
//
// Fails with file, line and reason. Letters other than ASCII are allowed in strings and
// comments alone, as TOML has it; they are refused here, before the parser, because that of
// toml++ 3.3 is not defined for some of them. Any thread.
#pragma once

#include <filesystem>
#include <string_view>

#include <tl/expected.hpp>

#include "services/bench/file/bench_problem.hpp"
#include "services/bench/file/toml_names.hpp"

namespace dyncal::inline bench {

[[nodiscard]] tl::expected<toml::table, BenchProblem> parse_toml(std::string_view text,
                                                                 const std::filesystem::path& path);

} // namespace dyncal::inline bench
