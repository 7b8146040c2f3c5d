#include "services/programs/web/access_tokens.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <openssl/evp.h>
#include <strings.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>

#include <fmt/core.h>

namespace dyncal::inline programs::web {
namespace {

tl::unexpected<Error> refuse(const std::filesystem::path& path, const std::string& why) {
  return fail(ErrorCode::bad_file, fmt::format("{}: {}", path.string(), why));
}

std::optional<Role> role_of(const std::string& word) {
  return word == "watch"     ? std::optional(Role::watch)
         : word == "operate" ? std::optional(Role::operate)
                             : std::nullopt;
}

struct Line {
  int number = 0;
  std::string text;
  std::vector<std::string> words; // before a comment; some
};

std::vector<Line> lines_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<Line> lines;
  std::string text;
  for (int number = 1; std::getline(file, text); ++number) {
    std::istringstream words(text.substr(0, text.find('#')));
    Line line{number,
              text,
              {std::istream_iterator<std::string>(words), std::istream_iterator<std::string>()}};
    if (!line.words.empty()) {
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

// Which may have spaces, so that one of three words may be a line whose role is spelt wrong.
bool is_a_token_alone(const Line& line) {
  const bool may_be_a_holder =
      line.words.size() == 3 && line.words.back().size() >= AccessTokens::min_length;
  return !role_of(line.words.front()) && !may_be_a_holder;
}

std::string base64(const std::string& text) {
  std::string coded(4 * ((text.size() + 2) / 3) + 1, '\0'); // and a zero
  const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(coded.data()),
                                     reinterpret_cast<const unsigned char*>(text.data()),
                                     static_cast<int>(text.size()));
  coded.resize(static_cast<std::size_t>(length));
  return coded;
}

// What follows the scheme, in any case of it (RFC 9110, 11.1); empty: it is another one.
std::string_view credentials_of(std::string_view header, std::string_view scheme) {
  const bool is_it = header.size() > scheme.size() &&
                     strncasecmp(header.data(), scheme.data(), scheme.size()) == 0;
  return is_it ? header.substr(scheme.size()) : std::string_view();
}

} // namespace

Expected<std::vector<TokenHolder>> read_tokens(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && (status.st_mode & S_IROTH) != 0) {
    return refuse(path, "everybody on this computer can read this token; chmod o= it");
  }
  const std::vector<Line> lines = lines_of(path);
  if (lines.empty()) {
    return refuse(path, "no token can be read; one is a line");
  }
  std::vector<TokenHolder> holders;
  for (const Line& line : lines) {
    const auto role = role_of(line.words.front());
    if (lines.size() == 1 && is_a_token_alone(line)) {
      holders.push_back({.token = line.text});
    } else if (line.words.size() == 3 && role) {
      holders.push_back({*role, line.words[1], line.words[2]});
    } else {
      return refuse(path, fmt::format("line {} is not ROLE NAME TOKEN, with watch or operate for "
                                      "the role",
                                      line.number));
    }
    if (holders.back().token.size() < AccessTokens::min_length) {
      return refuse(path, fmt::format("the token of line {} is too short: at least {} characters, "
                                      "e.g. of 'openssl rand -hex 32'",
                                      line.number, AccessTokens::min_length));
    }
  }
  return holders;
}

AccessTokens::AccessTokens(std::vector<TokenHolder> holders, bus::Clock& clock)
    : holders_(std::move(holders)),
      are_needed_to_watch_(std::ranges::count(holders_, Role::watch, &TokenHolder::role) > 0),
      clock_(clock) {}

// All of them are compared, whoever it is.
const TokenHolder* AccessTokens::holder_of(std::string_view header) const {
  const std::string_view token = credentials_of(header, "Bearer ");
  const std::string_view name_and_token = credentials_of(header, "Basic ");
  const TokenHolder* found = nullptr;
  for (const TokenHolder& holder : holders_) {
    const bool is_token = is_same_secret(holder.token, token);
    const bool is_both = is_same_secret(base64(holder.name + ":" + holder.token), name_and_token);
    found = is_token || is_both ? &holder : found;
  }
  return found;
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

AccessTokens::Answer AccessTokens::check(std::string_view header, const std::string& address,
                                         Role needed, TokenUse use) {
  const std::lock_guard lock(mutex_);
  const bus::Clock::Instant now = clock_.now();
  forget_old(now);
  const std::string counted = counted_address(address);
  const auto wrong = wrong_.find(counted);
  const bool is_locked = wrong != wrong_.end() && wrong->second.size() >= max_wrong;
  const TokenHolder* holder = holder_of(header);
  if (holder != nullptr && (!is_locked || use == TokenUse::stops_the_exciter)) {
    const bool is_enough = needed == Role::watch || holder->role == Role::operate;
    return {is_enough ? TokenAnswer::right : TokenAnswer::not_enough, holder->name};
  }
  if (is_locked) {
    return {TokenAnswer::too_many};
  }
  if (header.empty()) {
    return {TokenAnswer::none};
  }
  count_wrong(counted, now);
  return {TokenAnswer::wrong};
}

std::size_t AccessTokens::counted_addresses() const {
  const std::lock_guard lock(mutex_);
  return wrong_.size();
}

void AccessTokens::forget_old(bus::Clock::Instant now) {
  for (auto& [address, wrong] : wrong_) {
    while (!wrong.empty() && now - wrong.front() >= wrong_period) {
      wrong.pop_front();
    }
  }
  std::erase_if(wrong_, [](const auto& counted) { return counted.second.empty(); });
}

void AccessTokens::count_wrong(const std::string& address, bus::Clock::Instant now) {
  if (!wrong_.contains(address) && wrong_.size() >= max_addresses) {
    wrong_.erase(std::ranges::min_element(
        wrong_, {}, [](const auto& counted) { return counted.second.back(); }));
  }
  wrong_[address].push_back(now);
}

} // namespace dyncal::inline programs::web
