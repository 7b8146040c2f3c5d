#include "services/records/run_folder/folder_access.hpp"

#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <vector>

namespace dyncal::inline records {
namespace {

std::optional<gid_t> number_of(const std::string& group) {
  std::array<char, 65536> names{}; // of its members, too
  struct group entry {};
  struct group* found = nullptr;
  return getgrnam_r(group.c_str(), &entry, names.data(), names.size(), &found) == 0 &&
                 found != nullptr
             ? std::optional(entry.gr_gid)
             : std::nullopt;
}

bool is_ours(gid_t group) {
  std::vector<gid_t> ours(static_cast<std::size_t>(std::max(getgroups(0, nullptr), 0)));
  const int count = getgroups(static_cast<int>(ours.size()), ours.data());
  ours.resize(static_cast<std::size_t>(std::max(count, 0)));
  return group == getegid() || std::ranges::find(ours, group) != ours.end();
}

} // namespace

FolderAccess::FolderAccess(const std::string& group) : group_(number_of(group)) {
  if (group_ && !is_ours(*group_)) {
    group_.reset();
  }
}

void FolderAccess::set_umask() const {
  ::umask(group_ ? 0027 : 0077);
}

int FolderAccess::make_folder(const std::filesystem::path& folder) const {
  if (::mkdir(folder.c_str(), 0777) != 0) {
    return errno;
  }
  // A service has the group already, and its unit forbids the bit by which files take it.
  if (!group_ || *group_ == ::getegid()) {
    return 0;
  }
  const bool handed = ::chown(folder.c_str(), static_cast<uid_t>(-1), *group_) == 0 &&
                      ::chmod(folder.c_str(), S_ISGID | S_IRWXU | S_IRGRP | S_IXGRP) == 0;
  return handed ? 0 : errno;
}

int FolderAccess::make_folders(const std::filesystem::path& folder) const {
  std::error_code problem;
  if (folder.empty() || std::filesystem::is_directory(folder, problem)) {
    return 0;
  }
  const int above = folder.has_parent_path() ? make_folders(folder.parent_path()) : 0;
  const int made = above == 0 ? make_folder(folder) : above;
  return made == EEXIST ? 0 : made; // by another run, meanwhile
}

} // namespace dyncal::inline records
