// Who does something, and from where: a name that the person states, and the user and host that the
// operating system knows. The user is that of the process, not of its environment; of a program
// that is started by a daemon it is the daemon's.
//
// Plain functions, any thread.
#pragma once

#include <string>

namespace dyncal::inline base {

struct ActingPerson {
  std::string name{}; // as stated; may be empty
  std::string user{};
  std::string host{};

  friend bool operator==(const ActingPerson&, const ActingPerson&) = default;
};

// This process's, here. `stated_name`: as typed; empty: that in $DYNCAL_OPERATOR, if any.
[[nodiscard]] ActingPerson acting_person(std::string stated_name = "");

// "A. Meter", or the user where no name was stated.
[[nodiscard]] std::string name_of(const ActingPerson& person);
// "A. Meter (meter on lab3)", "meter on lab3".
[[nodiscard]] std::string text_of(const ActingPerson& person);

} // namespace dyncal::inline base
