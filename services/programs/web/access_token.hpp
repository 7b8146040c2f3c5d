// The secret that actions need: read from a file, compared in constant time, and guessed at no more
// than `max_wrong` times in `wrong_period` from one address.
//
// Wrong ones count by the visitor's address, of IPv6 by its network of 64 bits, which is what one
// computer has: anyone who guesses locks out nobody but himself. What stops an exciter is never
// locked for the right token, from any address; there, guesses are counted and refused but the
// right one shows, so that the secret's length is what protects it. Of `max_addresses` the one that
// was wrong longest ago is forgotten.
//
// The file has one line of at least 16 characters. Fails (bad_file) if it cannot be read, is
// shorter, or may be read by everybody on the machine. Any thread.
#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "services/base/error.hpp"
#include "services/bus/clock.hpp"

namespace dyncal::inline programs::web {

[[nodiscard]] Expected<std::string> read_token(const std::filesystem::path& path);

// Whatever is equal of them, it takes the same time.
[[nodiscard]] bool is_same_secret(std::string_view one, std::string_view other);

// As wrong tokens are counted: "192.0.2.7", "2001:db8:0:1::/64".
[[nodiscard]] std::string counted_address(const std::string& address);

enum class TokenAnswer { right, wrong, too_many };
enum class TokenUse { ordinary, stops_the_exciter };

class AccessToken {
public:
  static constexpr std::size_t min_length = 16;
  static constexpr std::size_t max_wrong = 5;
  static constexpr std::chrono::seconds wrong_period{60};
  static constexpr std::size_t max_addresses = 1024; // some 200 kB

  // `clock` outlives the object.
  AccessToken(std::string token, bus::Clock& clock) : token_(std::move(token)), clock_(clock) {}

  // `header`: Authorization, "Bearer TOKEN". Too many wrong ones from this address: there even the
  // right one is refused, but for what stops the exciter.
  [[nodiscard]] TokenAnswer check(std::string_view header, const std::string& address,
                                  TokenUse use = TokenUse::ordinary);
  [[nodiscard]] std::size_t counted_addresses() const;

private:
  using Wrong = std::deque<bus::Clock::Instant>; // the newest last

  void forget_old(bus::Clock::Instant now);
  void count_wrong(const std::string& address, bus::Clock::Instant now);

  std::string token_;
  bus::Clock& clock_;
  mutable std::mutex mutex_;
  std::map<std::string, Wrong> wrong_; // by address; none is empty
};

} // namespace dyncal::inline programs::web
