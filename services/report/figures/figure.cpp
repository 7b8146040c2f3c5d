#include "services/report/figures/figure.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

namespace dyncal::services::figures {
namespace {

Expected<void> write_text(const std::filesystem::path& path, const std::string& text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (file) {
    return {};
  }
  return fail(ErrorCode::bad_file,
              fmt::format("{}: cannot be written ({}); choose another folder", path.string(),
                          errno != 0 ? std::strerror(errno) : "unknown cause"));
}

} // namespace

Expected<std::vector<std::filesystem::path>> write(const Figure& figure,
                                                   const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) {
    return fail(ErrorCode::bad_file, fmt::format("{}: cannot be made a folder ({}); choose another",
                                                 folder.string(), failure.message()));
  }
  const std::vector<std::filesystem::path> paths = {folder / (figure.name + ".svg"),
                                                    folder / (figure.name + ".csv")};
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (auto written = write_text(paths[i], i == 0 ? figure.svg : figure.csv); !written) {
      return fail(written.error());
    }
  }
  return paths;
}

std::string csv_comment(const std::string& text) {
  std::string line = "# " + text + "\n";
  std::replace_if(
      line.begin(), line.end() - 1, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return line;
}

std::string csv_number(double value) {
  return fmt::format("{:.17g}", value);
}

} // namespace dyncal::services::figures
