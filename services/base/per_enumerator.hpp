// What belongs to each value of an enumeration, in its order: a text, or a value of another one.
//
//   return per_enumerator(state, {"unknown", "planned", "running", "done", "aborted"});
//
// The values count from 0. Does not compile with fewer or more entries than the enumeration has. A
// value beyond it, as a message of a later version may have, is `otherwise`. Any thread.
#pragma once

#include <cstddef>
#include <string_view>

namespace dyncal::inline base {

// Compilers write what is no enumerator as a cast number: "value = (dyncal::Severity)5".
template <auto value>
[[nodiscard]] consteval bool is_enumerator() {
  const std::string_view signature = __PRETTY_FUNCTION__;
  const char after_cast = signature[signature.rfind(')') + 1];
  return after_cast < '0' || after_cast > '9';
}

template <class Enum, class T, std::size_t count>
[[nodiscard]] constexpr T per_enumerator(Enum value, const T (&entries)[count], T otherwise) {
  static_assert(is_enumerator<static_cast<Enum>(count - 1)>(), "more entries than enumerators");
  static_assert(!is_enumerator<static_cast<Enum>(count)>(), "fewer entries than enumerators");
  const auto place = static_cast<std::size_t>(value);
  return place < count ? entries[place] : otherwise;
}

template <class Enum, class T, std::size_t count>
[[nodiscard]] constexpr T per_enumerator(Enum value, const T (&entries)[count]) {
  return per_enumerator(value, entries, entries[0]);
}

} // namespace dyncal::inline base
