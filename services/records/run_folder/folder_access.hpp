// Who may read what a run keeps: the group `dyncal`, which the services run as, where this process
// belongs to it; else the person alone who conducts the run.
//
// The first of a folder's files is safe already: the umask is set before anything is written. Sets
// it for the whole process: before it has threads that write files.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>

namespace dyncal::inline records {

class FolderAccess {
public:
  // `group`: by its name.
  explicit FolderAccess(const std::string& group = "dyncal");

  // 0027 with the group, else 0077.
  void set_umask() const;
  // Makes the folder and those above it that are missing; what is made belongs to the group, and so
  // will the files in it. Returns 0, or errno.
  [[nodiscard]] int make_folders(const std::filesystem::path& folder) const;
  [[nodiscard]] int make_folder(const std::filesystem::path& folder) const;

private:
  std::optional<gid_t> group_; // nothing: there is none, or this process does not belong to it
};

} // namespace dyncal::inline records
