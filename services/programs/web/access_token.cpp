#include "services/programs/web/access_token.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <strings.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>

#include <fmt/core.h>

namespace dyncal::inline programs::web {

Expected<std::string> read_token(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && (status.st_mode & S_IROTH) != 0) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: everybody on this computer can read this token; chmod o= it",
                            path.string()));
  }
  std::ifstream file(path);
  std::string token;
  if (!std::getline(file, token)) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: the token cannot be read; it is one line", path.string()));
  }
  if (token.size() < AccessToken::min_length) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: the token is too short: at least {} characters, e.g. of "
                            "'openssl rand -hex 32'",
                            path.string(), AccessToken::min_length));
  }
  return token;
}

bool is_same_secret(std::string_view one, std::string_view other) {
  unsigned difference = one.size() == other.size() ? 0U : 1U;
  for (std::size_t i = 0; i < other.size(); ++i) {
    const char letter = one.empty() ? '\0' : one[i % one.size()];
    difference |= static_cast<unsigned char>(letter) ^ static_cast<unsigned char>(other[i]);
  }
  return difference == 0U;
}

std::string counted_address(const std::string& address) {
  in6_addr bytes{};
  if (inet_pton(AF_INET6, address.c_str(), &bytes) != 1) {
    return address;
  }
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (IN6_IS_ADDR_V4MAPPED(&bytes)) {
    inet_ntop(AF_INET, &bytes.s6_addr[12], text.data(), text.size());
    return text.data();
  }
  std::fill(std::begin(bytes.s6_addr) + 8, std::end(bytes.s6_addr), std::uint8_t{0});
  inet_ntop(AF_INET6, &bytes, text.data(), text.size());
  return std::string(text.data()) + "/64";
}

TokenAnswer AccessToken::check(std::string_view header, const std::string& address, TokenUse use) {
  const std::lock_guard lock(mutex_);
  const bus::Clock::Instant now = clock_.now();
  forget_old(now);
  const std::string counted = counted_address(address);
  const auto wrong = wrong_.find(counted);
  const bool is_locked = wrong != wrong_.end() && wrong->second.size() >= max_wrong;
  constexpr std::string_view scheme = "Bearer "; // in any case (RFC 9110, 11.1)
  const bool is_right = header.size() > scheme.size() &&
                        strncasecmp(header.data(), scheme.data(), scheme.size()) == 0 &&
                        is_same_secret(token_, header.substr(scheme.size()));
  if (is_right && (!is_locked || use == TokenUse::stops_the_exciter)) {
    return TokenAnswer::right;
  }
  if (is_locked) {
    return TokenAnswer::too_many;
  }
  count_wrong(counted, now);
  return TokenAnswer::wrong;
}

std::size_t AccessToken::counted_addresses() const {
  const std::lock_guard lock(mutex_);
  return wrong_.size();
}

void AccessToken::forget_old(bus::Clock::Instant now) {
  for (auto& [address, wrong] : wrong_) {
    while (!wrong.empty() && now - wrong.front() >= wrong_period) {
      wrong.pop_front();
    }
  }
  std::erase_if(wrong_, [](const auto& counted) { return counted.second.empty(); });
}

void AccessToken::count_wrong(const std::string& address, bus::Clock::Instant now) {
  if (!wrong_.contains(address) && wrong_.size() >= max_addresses) {
    wrong_.erase(std::ranges::min_element(
        wrong_, {}, [](const auto& counted) { return counted.second.back(); }));
  }
  wrong_[address].push_back(now);
}

} // namespace dyncal::inline programs::web
