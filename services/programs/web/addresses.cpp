#include "services/programs/web/addresses.hpp"

#include <algorithm>
#include <array>
#include <string>

#include <fmt/core.h>

#include "services/programs/web/laboratory_answers.hpp"

namespace dyncal::inline programs::web {
namespace {

constexpr std::array<std::string_view, 5> read_addresses{"/", "/events", "/api/laboratory",
                                                         "/api/history", "/api/bench-files"};
constexpr std::array<std::string_view, 4> read_folders{"/page/", "/javascript/", "/guide/",
                                                       "/files/"};

} // namespace

const char* methods_of(std::string_view path) {
  if (path == "*") {
    return all_methods;
  }
  const auto address = bench_address(path);
  if (path == "/api/run" || (address && address->part == "command")) {
    return acting_methods;
  }
  const bool is_read =
      address || std::ranges::find(read_addresses, path) != read_addresses.end() ||
      std::ranges::any_of(read_folders, [&](auto folder) { return path.starts_with(folder); });
  return is_read ? reading_methods : nullptr;
}

bool allows(std::string_view methods, std::string_view method) {
  return method.find(',') == std::string_view::npos &&
         fmt::format(" {},", methods).find(fmt::format(" {},", method)) != std::string::npos;
}

} // namespace dyncal::inline programs::web
