// The methods that an address answers (PROTOCOL.md has all addresses): for Allow, and to tell an
// address that is none (404) from a method that it does not answer (405). Plain function, any
// thread.
#pragma once

#include <string_view>

namespace dyncal::inline programs::web {

inline constexpr const char* reading_methods = "GET, HEAD, OPTIONS";
inline constexpr const char* acting_methods = "POST, OPTIONS";
inline constexpr const char* all_methods = "GET, HEAD, POST, OPTIONS";

// `path`: decoded, without parameters; "*": of the whole daemon. As Allow has it; null: no address
// looks like this one.
[[nodiscard]] const char* methods_of(std::string_view path);
// Whether `methods`, as above, has this one.
[[nodiscard]] bool allows(std::string_view methods, std::string_view method);

} // namespace dyncal::inline programs::web
