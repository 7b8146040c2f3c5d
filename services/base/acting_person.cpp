#include "services/base/acting_person.hpp"

#include <pwd.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

#include <fmt/core.h>

#include "services/base/printable_text.hpp"

namespace dyncal::inline base {
namespace {

std::string user_name() {
  std::array<char, 4096> buffer{};
  passwd entry{};
  passwd* found = nullptr;
  const uid_t user = getuid();
  return getpwuid_r(user, &entry, buffer.data(), buffer.size(), &found) == 0 && found != nullptr
             ? one_line(found->pw_name)
             : fmt::format("user {}", user);
}

std::string own_host() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? one_line(name.data()) : "unknown";
}

} // namespace

ActingPerson acting_person(std::string stated_name) {
  const char* usual = std::getenv("DYNCAL_OPERATOR");
  if (stated_name.empty() && usual != nullptr) {
    stated_name = usual;
  }
  return {one_line(stated_name), user_name(), own_host()};
}

std::string name_of(const ActingPerson& person) {
  return person.name.empty() ? person.user : person.name;
}

std::string text_of(const ActingPerson& person) {
  const std::string login = person.user + " on " + person.host;
  return person.name.empty() ? login : fmt::format("{} ({})", person.name, login);
}

} // namespace dyncal::inline base
