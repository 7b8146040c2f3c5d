// Text of SCPI commands as an instrument reads it.
//
// Written independently of what dyncal reads answers with (drivers/link/scpi_answer.hpp): one must
// not share the other's mistakes. Any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace dyncal::drivers::virtual_bench {

[[nodiscard]] std::string upper(std::string_view text);

// A number as a parameter; nothing when anything else stands there, so that the instrument
// complains.
[[nodiscard]] std::optional<double> parse_parameter(std::string_view text);

} // namespace dyncal::drivers::virtual_bench
