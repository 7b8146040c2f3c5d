#include "services/records/run_folder/folder_access.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <grp.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <vector>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline records {
namespace {

namespace fs = std::filesystem;

constexpr uid_t person = 65'534; // no group of Debian's is so by its number
constexpr const char* group = "games";

struct Access {
  mode_t mode = 0;
  gid_t group = 0;
};

Access access_of(const fs::path& path) {
  struct stat status {};
  EXPECT_EQ(::stat(path.c_str(), &status), 0) << path;
  return {status.st_mode & 07777U, status.st_gid};
}

class FolderAccessTest : public testing::Test {
protected:
  void SetUp() override {
    if (geteuid() != 0 || getgrnam(group) == nullptr) {
      GTEST_SKIP() << "SKIPPED: access to run folders is not tested: needs root and a group "
                   << group;
    }
    group_number_ = getgrnam(group)->gr_gid;
    fs::permissions(folder_.path(), fs::perms::all);
  }
  // What somebody makes who belongs to `groups` beside his own.
  void make_as_person(const std::vector<gid_t>& groups, gid_t own = person) const {
    const pid_t child = fork();
    if (child == 0) {
      const bool is_person =
          setgroups(groups.size(), groups.data()) == 0 && setgid(own) == 0 && setuid(person) == 0;
      const FolderAccess access(group);
      access.set_umask();
      const bool made = is_person && access.make_folders(run_.parent_path()) == 0 &&
                        access.make_folder(run_) == 0 &&
                        ::open((run_ / "result.json").c_str(), O_CREAT | O_WRONLY, 0666) >= 0;
      _exit(made ? 0 : 1);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_EQ(status, 0);
  }

  tests::TemporaryFolder folder_;
  fs::path run_ = folder_.path() / "runs" / "acc-1" / "run";
  gid_t group_number_ = 0;
};

TEST_F(FolderAccessTest, IsOfTheGroupOfTheServicesForWhoBelongsToIt) {
  make_as_person({group_number_});
  for (const fs::path& made : {run_, run_.parent_path(), run_.parent_path().parent_path()}) {
    EXPECT_EQ(access_of(made).mode, 02750U) << made;
    EXPECT_EQ(access_of(made).group, group_number_) << made;
  }
  EXPECT_EQ(access_of(run_ / "result.json").mode, 0640U);
  EXPECT_EQ(access_of(run_ / "result.json").group, group_number_);
}

TEST_F(FolderAccessTest, IsOfTheGroupWithoutTheBitThatUnitsForbid) {
  make_as_person({}, group_number_);
  EXPECT_EQ(access_of(run_).mode, 0750U);
  EXPECT_EQ(access_of(run_).group, group_number_);
  EXPECT_EQ(access_of(run_ / "result.json").mode, 0640U);
}

TEST_F(FolderAccessTest, IsOfThePersonAloneWhoDoesNotBelongToIt) {
  make_as_person({});
  EXPECT_EQ(access_of(run_).mode, 0700U);
  EXPECT_EQ(access_of(run_.parent_path()).mode, 0700U);
  EXPECT_EQ(access_of(run_ / "result.json").mode, 0600U);
}

TEST_F(FolderAccessTest, TellsWhyAFolderCannotBeMade) {
  EXPECT_EQ(FolderAccess("no such group").make_folders("/proc/run/folder"), ENOENT);
}

} // namespace
} // namespace dyncal::inline records
