#include "services/web/access_token.hpp"

#include <sys/stat.h>

#include <fstream>

#include <fmt/core.h>

namespace dyncal::services::web {

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

TokenAnswer AccessToken::check(std::string_view header) {
  const std::lock_guard lock(mutex_);
  const bus::Clock::Instant now = clock_.now();
  while (!wrong_.empty() && now - wrong_.front() >= wrong_period) {
    wrong_.pop_front();
  }
  if (wrong_.size() >= max_wrong) {
    return TokenAnswer::too_many;
  }
  constexpr std::string_view scheme = "Bearer ";
  if (header.starts_with(scheme) && is_same_secret(token_, header.substr(scheme.size()))) {
    return TokenAnswer::right;
  }
  wrong_.push_back(now);
  return TokenAnswer::wrong;
}

} // namespace dyncal::services::web
