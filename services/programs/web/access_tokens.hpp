// The secrets by which visitors of the page may watch or act: read from a file, compared in
// constant time, and guessed at no more than `max_wrong` times in `wrong_period` from one address.
//
// A visitor shows his as "Bearer TOKEN", or, since browsers ask for it by themselves and show it
// with every request of a page, as name and password (RFC 7617). Where somebody may only watch,
// nobody watches without a token.
//
// Wrong ones count by the visitor's address, of IPv6 by its network of 64 bits, which is what one
// computer has: anyone who guesses locks out nobody but himself. What stops an exciter is never
// locked for the right token, from any address; there, guesses are counted and refused but the
// right one shows, so that the secret's length is what protects it. Who shows none is refused and
// not counted. Of `max_addresses` the one that was wrong longest ago is forgotten. Any thread.
#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "services/base/error.hpp"
#include "services/bus/clock.hpp"

namespace dyncal::inline programs::web {

enum class Role { watch, operate };

struct TokenHolder {
  Role role = Role::operate;
  std::string name{}; // of a person or a screen; empty: the file names none
  std::string token;
};

// Lines of "ROLE NAME TOKEN", ROLE being watch or operate, NAME one word, and comments behind '#';
// or one line with nothing but a token, spaces among it, which operates. A token has at least 16
// characters. Fails (bad_file), with the line, if the file deviates, cannot be read, or may be read
// by everybody on the machine.
[[nodiscard]] Expected<std::vector<TokenHolder>> read_tokens(const std::filesystem::path& path);

// Whatever is equal of them, it takes the same time.
[[nodiscard]] bool is_same_secret(std::string_view one, std::string_view other);

// As wrong tokens are counted: "192.0.2.7", "2001:db8:0:1::/64".
[[nodiscard]] std::string counted_address(const std::string& address);

// `not_enough`: a right one, of somebody who may only watch.
enum class TokenAnswer { right, none, wrong, too_many, not_enough };
enum class TokenUse { ordinary, stops_the_exciter };

class AccessTokens {
public:
  static constexpr std::size_t min_length = 16;
  static constexpr std::size_t max_wrong = 5;
  static constexpr std::chrono::seconds wrong_period{60};
  static constexpr std::size_t max_addresses = 1024; // some 200 kB

  struct Answer {
    TokenAnswer answer = TokenAnswer::none;
    std::string name{}; // of who showed the right one
  };

  // `clock` outlives the object.
  AccessTokens(std::vector<TokenHolder> holders, bus::Clock& clock);

  [[nodiscard]] bool are_needed_to_watch() const { return are_needed_to_watch_; }
  // `header`: Authorization. Too many wrong ones from this address: there even the right one is
  // refused, but for what stops the exciter.
  [[nodiscard]] Answer check(std::string_view header, const std::string& address, Role needed,
                             TokenUse use = TokenUse::ordinary);
  [[nodiscard]] std::size_t counted_addresses() const;

private:
  using Wrong = std::deque<bus::Clock::Instant>; // the newest last

  [[nodiscard]] const TokenHolder* holder_of(std::string_view header) const;
  void forget_old(bus::Clock::Instant now);
  void count_wrong(const std::string& address, bus::Clock::Instant now);

  std::vector<TokenHolder> holders_;
  bool are_needed_to_watch_ = false;
  bus::Clock& clock_;
  mutable std::mutex mutex_;
  std::map<std::string, Wrong> wrong_; // by address; none is empty
};

} // namespace dyncal::inline programs::web
