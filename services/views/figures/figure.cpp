#include "services/views/figures/figure.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "services/base/output_file.hpp"

namespace dyncal::inline views::figures {

Expected<std::vector<std::filesystem::path>> write(const Figure& figure,
                                                   const std::filesystem::path& folder) {
  DYNCAL_TRY(check_output_folder(folder));
  const std::vector<std::filesystem::path> paths = {folder / (figure.name + ".svg"),
                                                    folder / (figure.name + ".csv")};
  for (std::size_t i = 0; i < paths.size(); ++i) {
    DYNCAL_TRY(write_output_file(paths[i], i == 0 ? figure.svg() : figure.csv));
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

} // namespace dyncal::inline views::figures
