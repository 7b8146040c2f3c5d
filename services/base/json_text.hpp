// JSON as it is written into files and answers. Texts that are not UTF-8 do not stop it, as they
// would by the library's own choice: a letter of them becomes U+FFFD. Plain function, any thread.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace dyncal::inline base {

// `indent`: of a level; -1: all in one line.
template <class Json>
[[nodiscard]] std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

} // namespace dyncal::inline base
