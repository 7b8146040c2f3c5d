// The words that begin the statements of a DBC file.
//
// BO_, SG_, BU_ and EV_ also stand within other statements, for the kind of thing that these are
// about (CM_ SG_ 291 x "..."): they begin one where what follows looks like it. Pure functions; any
// thread.
#pragma once

#include <string_view>

namespace dyncal::drivers::can {

// Statements that say nothing about how a frame is decoded.
[[nodiscard]] bool is_passed_over(std::string_view keyword);

// Whether a statement begins with the first thing of `text` that is not white space.
[[nodiscard]] bool begins_statement(std::string_view text);

} // namespace dyncal::drivers::can
