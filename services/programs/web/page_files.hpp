// The files of the folder page/, which the build puts into the program (EmbedPage.cmake). Plain
// data; any thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace dyncal::inline programs::web {

struct PageFile {
  std::string name; // "index.html"
  const char* bytes = nullptr;
  std::size_t count = 0;
};

[[nodiscard]] std::vector<PageFile> page_files();

} // namespace dyncal::inline programs::web
