#include "services/base/temporary_folder.hpp"

#include <cstdlib>
#include <string>
#include <system_error>

namespace dyncal::inline base {

TemporaryFolder::TemporaryFolder() {
  std::error_code unknown;
  std::string name = (std::filesystem::temp_directory_path(unknown) / "dyncal-XXXXXX").string();
  if (!unknown && mkdtemp(name.data()) != nullptr) {
    path_ = name;
  }
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (!path_.empty()) {
    std::filesystem::remove_all(path_, ignored);
  }
}

} // namespace dyncal::inline base
