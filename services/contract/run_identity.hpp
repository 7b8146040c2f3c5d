// What stands for one run on the network, in folders and in the store: unique by construction,
// while people see and type its name, which may come again.
//
// Text: NAME.START.CONDUCTOR, "R1.20261122T101530.125Z.4f2a91c0": the name as file systems take it
// (letters, digits, '-', '_', '.'; everything else becomes '_'), the instant in UTC at which its
// conductor began it, and a number that this conductor has drawn. A run without a name is
// START.CONDUCTOR, and START is its name. Texts of other forms (of programs before 0.3) are names.
// Fails (bad_argument) for a name of more than max_run_name characters: the contract's key has 64.
// Any thread.
#pragma once

#include <cstdint>
#include <string>

#include "services/base/error.hpp"

namespace dyncal::inline contract {

inline constexpr std::size_t max_run_name = 34; // 64 of the key, less ".START.CONDUCTOR"

struct RunIdentity {
  std::string name;
  std::string start;     // as time_name(); empty: not known
  std::string conductor; // eight hexadecimal digits; empty: not known

  [[nodiscard]] static Expected<RunIdentity> begin(const std::string& name, std::int64_t utc_ns);
  [[nodiscard]] static RunIdentity parse(const std::string& text);

  [[nodiscard]] std::string text() const;
  // Whether a person who types this means the run: its name, or the whole text.
  [[nodiscard]] bool is_called(const std::string& typed) const;
  // "2026-11-22 10:15:30 UTC"; empty where it is not known.
  [[nodiscard]] std::string since() const;
};

// "run 'R1' of lab-pc:1234, since 2026-11-22 10:15:30 UTC", as far as that is known. `run`: its
// text; `conductor`: host and process.
[[nodiscard]] std::string called_of(const std::string& run, const std::string& conductor);

// As it stands in the name of a file or folder.
[[nodiscard]] std::string safe_name(std::string name);

} // namespace dyncal::inline contract
