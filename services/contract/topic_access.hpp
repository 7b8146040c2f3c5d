// Who writes and who reads each topic of the contract, and in which partitions. The permissions of
// a secured laboratory are made from it (services/security), and idl/README.md shows it.
//
// A role is what a certificate lets its holder be. Roles that serve a bench write in its partition,
// and in those of its runs; who reads the bench reads both. Plain data; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dyncal::inline contract {

enum class SecurityRole : std::uint8_t {
  source,    // programs of instruments; `dyncal replay`
  analysis,  // dyncal-analysis
  guard,     // dyncal-guard
  conductor, // "operator": `dyncal run` and `dyncal calibrate`
  recorder,  // dyncal-recorder
  web,       // dyncal-web
  watcher    // `dyncal watch`, `list`, `doctor`
};

enum class TopicPlace : std::uint8_t {
  bench,      // the bench, its runs, and who catches up with its sources
  laboratory, // the partition of all benches
};

struct TopicAccess {
  const char* topic;
  TopicPlace place;
  std::vector<SecurityRole> writers;
  std::vector<SecurityRole> readers;
};

// In the order of topics.hpp.
[[nodiscard]] const std::vector<TopicAccess>& topic_access();

[[nodiscard]] const std::vector<SecurityRole>& security_roles();
[[nodiscard]] const char* to_string(SecurityRole role);
// Nothing for any other name.
[[nodiscard]] std::optional<SecurityRole> parse_security_role(std::string_view name);

// Whether it belongs to single benches. The others serve or watch all of them.
[[nodiscard]] constexpr bool is_of_a_bench(SecurityRole role) {
  return role == SecurityRole::source || role == SecurityRole::guard ||
         role == SecurityRole::conductor;
}
// Whether it reads all benches, whichever it writes for.
[[nodiscard]] constexpr bool reads_all_benches(SecurityRole role) {
  return role != SecurityRole::source && role != SecurityRole::guard;
}

// Topics that a role writes, or reads, in the same partitions.
struct TopicGroup {
  std::vector<std::string> topics;
  std::vector<std::string> partitions;
};
struct RoleAccess {
  std::vector<TopicGroup> written;
  std::vector<TopicGroup> read;
};
// `benches`: of a role that belongs to some; the others serve all.
[[nodiscard]] RoleAccess access_of(SecurityRole role, const std::vector<std::string>& benches);

} // namespace dyncal::inline contract
