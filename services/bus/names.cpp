#include "services/bus/names.hpp"

#include <algorithm>
#include <string_view>

namespace dyncal::bus {
namespace {

constexpr std::string_view pattern_characters = "*?[]";

base::Error bad_name(const std::string& what, const std::string& name, const std::string& why) {
  return {base::ErrorCode::bad_argument, what + " \"" + name + "\" " + why};
}

base::Expected<void> check_partition(const std::string& what, const std::string& name,
                                     std::size_t longest) {
  if (auto fits = check_name(what, name, longest); !fits) {
    return fits;
  }
  if (name.find_first_of(pattern_characters) != std::string::npos) {
    return fail(bad_name(
        what, name, "contains one of * ? [ ], which stand for other names in DDS: leave it out"));
  }
  return {};
}

} // namespace

base::Expected<void> check_name(const std::string& what, const std::string& name,
                                std::size_t longest) {
  if (name.empty()) {
    return fail(base::ErrorCode::bad_argument, what + " has no name: give it one");
  }
  if (name.size() > longest) {
    return fail(bad_name(what, name,
                         "is too long: " + std::to_string(name.size()) + " bytes, shorten it to " +
                             std::to_string(longest)));
  }
  return {};
}

base::Expected<void> check_bench_name(const std::string& name) {
  return check_partition("bench", name, max_name);
}

base::Expected<void> check_asker_name(const std::string& name) {
  return check_partition("asker", name, max_asker);
}

std::string partition_of_run(const std::string& bench, std::string run) {
  std::ranges::replace_if(
      run, [](char one) { return pattern_characters.find(one) != std::string_view::npos; }, '_');
  return bench + "/" + run;
}

} // namespace dyncal::bus
