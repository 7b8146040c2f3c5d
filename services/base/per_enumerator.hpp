// What belongs to each value of an enumeration, in its order: a text, or a value of another one.
//
//   return per_enumerator(state, {"unknown", "planned", "running", "done", "aborted"});
//
// The values count from 0. Does not compile with fewer or more entries than the enumeration has. A
// value beyond it, as a message of a later version may have, is `otherwise`. Texts that to_string()
// has for the values are read again by parse_enumerator(). Any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

template <class Enum, std::size_t count = 0>
[[nodiscard]] consteval std::size_t number_of_enumerators() {
  if constexpr (is_enumerator<static_cast<Enum>(count)>()) {
    return number_of_enumerators<Enum, count + 1>();
  } else {
    return count;
  }
}

// The texts of all values.
template <class Enum>
[[nodiscard]] std::vector<std::string> enumerator_texts() {
  std::vector<std::string> texts;
  for (std::size_t place = 0; place < number_of_enumerators<Enum>(); ++place) {
    texts.emplace_back(to_string(static_cast<Enum>(place)));
  }
  return texts;
}

// Nothing: no value has this text.
template <class Enum>
[[nodiscard]] std::optional<Enum> parse_enumerator(std::string_view text) {
  for (std::size_t place = 0; place < number_of_enumerators<Enum>(); ++place) {
    if (to_string(static_cast<Enum>(place)) == text) {
      return static_cast<Enum>(place);
    }
  }
  return std::nullopt;
}

} // namespace dyncal::inline base
