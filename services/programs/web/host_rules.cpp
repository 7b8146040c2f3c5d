#include "services/programs/web/host_rules.hpp"

#include <arpa/inet.h>
#include <strings.h>

#include <algorithm>
#include <array>

#include <fmt/core.h>

namespace dyncal::inline programs::web {
namespace {

// Without the port; of "[::1]:80" what is in the brackets. Empty: it is none.
std::string name_of(std::string_view host) {
  if (host.starts_with('[')) {
    const auto end = host.find(']');
    return end == std::string_view::npos ? std::string() : std::string(host.substr(1, end - 1));
  }
  return std::string(host.substr(0, host.find(':')));
}

bool is_address(const std::string& name) {
  std::array<unsigned char, sizeof(in6_addr)> address{};
  return inet_pton(AF_INET, name.c_str(), address.data()) == 1 ||
         inet_pton(AF_INET6, name.c_str(), address.data()) == 1;
}

} // namespace

bool is_own_host(std::string_view host, const std::vector<std::string>& own_names) {
  const std::string name = name_of(host);
  const auto is_name = [&](const std::string& own) {
    return strcasecmp(own.c_str(), name.c_str()) == 0;
  };
  return is_address(name) || is_name("localhost") ||
         (!name.empty() && std::any_of(own_names.begin(), own_names.end(), is_name));
}

bool is_own_origin(std::string_view origin, std::string_view host) {
  return origin.empty() || origin == fmt::format("http://{}", host) ||
         origin == fmt::format("https://{}", host);
}

} // namespace dyncal::inline programs::web
