#include "services/programs/recorder/recording_name.hpp"

#include <cctype>

#include <fmt/core.h>

namespace dyncal::inline programs {
namespace {

std::string portable(std::string name) {
  for (char& letter : name) {
    const auto code = static_cast<unsigned char>(letter);
    const bool is_fine = (code < 128 && std::isalnum(code) != 0) ||
                         std::string("._-+").find(letter) != std::string::npos;
    letter = is_fine ? letter : '_';
  }
  if (name.empty() || name.front() == '.') {
    name.insert(0, "_");
  }
  return name;
}

} // namespace

std::filesystem::path recording_name(const std::filesystem::path& folder, const std::string& bench,
                                     const std::string& name) {
  const std::filesystem::path of_bench = folder / portable(bench);
  std::filesystem::path path = of_bench / (portable(name) + ".mcap");
  for (int number = 2; std::filesystem::exists(path); ++number) {
    path = of_bench / fmt::format("{}-{}.mcap", portable(name), number);
  }
  return path;
}

} // namespace dyncal::inline programs
