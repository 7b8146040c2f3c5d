// Puts a new `dyncal run` in the place of this one, which nobody hears any more: the addresses that
// its participant announced are gone.
//
// The process stays (number, terminal, standard output), the program in it begins again, as after a
// kill: with --resume where something was excited, otherwise as it was called.
#pragma once

#include <string>
#include <vector>

namespace dyncal::inline programs {

// `own`: as the program was called, its name first. `resume`: the run to go on with; empty: none.
[[nodiscard]] std::vector<std::string> arguments_again(const std::vector<std::string>& own,
                                                       const std::string& resume);

// Says why, ends all threads of this program and begins. Any thread. Returns only where the system
// refuses.
void run_again(const std::string& why, const std::string& resume);

} // namespace dyncal::inline programs
