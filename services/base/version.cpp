#include "services/base/version.hpp"

#include "commit.hpp"

namespace dyncal::inline base {
namespace {

std::string compiler() {
#ifdef __clang__
  return "Clang " __clang_version__;
#else
  return "GCC " __VERSION__;
#endif
}

} // namespace

std::string software_version() {
  const std::string version = "dyncal " DYNCAL_VERSION;
  return commit.empty() ? version : version + " (" + std::string(commit) + ")";
}

std::string build_description() {
  const std::string dds = DYNCAL_DDS;
  return software_version() + "\nDDS implementations: " + (dds.empty() ? "none" : dds) +
         "\ncompiler: " + compiler() + ", " DYNCAL_BUILD_TYPE;
}

} // namespace dyncal::inline base
