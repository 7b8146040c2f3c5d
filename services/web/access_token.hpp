// The secret that actions need: read from a file, compared in constant time, and guessed at no more
// than `max_wrong` times in `wrong_period` by all together.
//
// The file has one line of at least 16 characters. Fails (bad_file) if it cannot be read, is
// shorter, or may be read by everybody on the machine. Any thread.
#pragma once

#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>

#include "services/bus/clock.hpp"
#include "services/error.hpp"

namespace dyncal::services::web {

[[nodiscard]] Expected<std::string> read_token(const std::filesystem::path& path);

// Whatever is equal of them, it takes the same time.
[[nodiscard]] bool is_same_secret(std::string_view one, std::string_view other);

enum class TokenAnswer { right, wrong, too_many };

class AccessToken {
public:
  static constexpr std::size_t min_length = 16;
  static constexpr std::size_t max_wrong = 5;
  static constexpr std::chrono::seconds wrong_period{60};

  // `clock` outlives the object.
  AccessToken(std::string token, bus::Clock& clock) : token_(std::move(token)), clock_(clock) {}

  // `header`: Authorization, "Bearer TOKEN". Too many wrong ones: even the right one is refused.
  [[nodiscard]] TokenAnswer check(std::string_view header);

private:
  std::string token_;
  bus::Clock& clock_;
  std::mutex mutex_;
  std::deque<bus::Clock::Instant> wrong_;
};

} // namespace dyncal::services::web
