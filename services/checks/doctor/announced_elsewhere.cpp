#include "services/checks/doctor/announced_elsewhere.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace dyncal::inline checks::doctor {
namespace {

constexpr std::size_t max_named = 4;

struct Announcers {
  std::set<std::string> programs;
  std::set<std::string> addresses;
};

std::string few_of(const std::set<std::string>& names) {
  std::vector<std::string> named(names.begin(), names.end());
  if (named.size() > max_named) {
    named.resize(max_named);
    named.push_back(fmt::format("{} more", names.size() - max_named));
  }
  return fmt::format("{}", fmt::join(named, ", "));
}

} // namespace

std::string announced_elsewhere(const LaboratoryView& view) {
  const bool any_of_dyncal = std::ranges::any_of(
      view.announced_elsewhere, [](const auto& one) { return !one.program.empty(); });
  std::map<std::pair<int, std::string>, Announcers> places; // domain, interface if it is our domain
  for (const Announcement& one : view.announced_elsewhere) {
    if (any_of_dyncal && one.program.empty()) {
      continue;
    }
    Announcers& place =
        places[{one.domain, one.domain == view.domain ? one.interface : std::string()}];
    place.programs.insert(one.program.empty() ? "a program of others" : one.program);
    place.addresses.insert(one.address);
  }
  std::vector<std::string> texts;
  for (const auto& [place, announcers] : places) {
    const std::string who = few_of(announcers.programs);
    const char* verb = announcers.programs.size() == 1 ? "announces itself" : "announce themselves";
    const std::string from = few_of(announcers.addresses);
    texts.push_back(
        place.first == view.domain
            ? fmt::format(
                  "{0} {1} on the network of interface {2}, from {3}, and this program uses "
                  "another one: give --interface {2}, or none",
                  who, verb, place.second, from)
            : fmt::format("{} {} in DDS domain {}, from {}: give --domain {}", who, verb,
                          place.first, from, place.first));
  }
  return fmt::format("{}", fmt::join(texts, "; "));
}

} // namespace dyncal::inline checks::doctor
