#include "services/records/run_folder/run_folder.hpp"

#include <fcntl.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "services/base/whole_file.hpp"
#include "services/bench/file/named_files.hpp"
#include "services/contract/run_identity.hpp"
#include "services/contract/time_name.hpp"
#include "services/records/run_folder/folder_access.hpp"
#include "services/records/run_folder/folder_copy.hpp"
#include "services/views/report/run_figures.hpp"

namespace dyncal::inline records {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t max_bench_bytes = 16U << 20U; // of the copy, which was a bench file once
using drivers::FileDescriptor;

Error cannot_make(const fs::path& folder, const std::string& reason) {
  return {ErrorCode::bad_file,
          fmt::format("{}: the run folder cannot be made ({}); choose another place with --folder",
                      folder.string(), reason)};
}

FileDescriptor open_folder(const fs::path& folder) {
  return FileDescriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
}

Expected<FileDescriptor> lock_folder(const fs::path& folder) {
  FileDescriptor lock = open_folder(folder);
  if (!lock.is_open()) {
    return fail(cannot_make(folder, std::strerror(errno)));
  }
  if (::flock(lock.number(), LOCK_EX | LOCK_NB) != 0) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: another program writes into this run folder; wait for its end",
                            folder.string()));
  }
  return lock;
}

std::uint64_t free_on_disk(const fs::path& folder) {
  struct statvfs disk {};
  return ::statvfs(folder.c_str(), &disk) == 0 ? std::uint64_t{disk.f_bavail} * disk.f_frsize : 0;
}

Expected<void> check_free(const fs::path& folder, std::uint64_t need, const std::string& what) {
  const std::uint64_t free = free_on_disk(folder);
  if (need <= free) {
    return {};
  }
  return fail(ErrorCode::bad_file,
              fmt::format("{}: {} about {} but {} are free there; make room, or choose another "
                          "disk with --folder",
                          folder.string(), what, size_text(need), size_text(free)));
}

// Under its name only when all of it is there; a folder that has the name stays.
Expected<void> take_name(const fs::path& unfinished, const fs::path& folder) {
  if (::renameat2(AT_FDCWD, unfinished.c_str(), AT_FDCWD, folder.c_str(), RENAME_NOREPLACE) == 0) {
    return {};
  }
  if (errno == EINVAL && !fs::exists(folder) && ::rename(unfinished.c_str(), folder.c_str()) == 0) {
    return {}; // a file system without RENAME_NOREPLACE
  }
  return fail(cannot_make(folder, std::strerror(errno)));
}

Expected<void> fill(const fs::path& unfinished, const BenchFile& bench) {
  return check_free(unfinished, bytes_of_bench(bench), "bench file and the files it names need")
      .and_then([&] { return copy_bench(bench, unfinished); });
}

// Folders of programs before 0.3 are RUN itself, or TIME-RUN.
std::optional<RunIdentity> run_of_folder(const std::string& folder, const std::string& typed) {
  const RunIdentity run = RunIdentity::parse(folder);
  if (run.is_called(typed)) {
    return run;
  }
  constexpr std::size_t time_size = std::string_view("20261122T101530.125Z").size();
  if (run.conductor.empty() && folder.size() > time_size &&
      is_time_name(folder.substr(0, time_size)) &&
      folder.substr(time_size) == "-" + safe_name(typed)) {
    return RunIdentity{typed, folder.substr(0, time_size), ""};
  }
  return folder == safe_name(typed) ? std::optional(run) : std::nullopt;
}

// Of a run that is resumed: results by two bench files would stand side by side.
Expected<void> check_same_bench(const fs::path& folder, const BenchFile& bench) {
  DYNCAL_TRY(const auto begun_with, read_whole_file(folder / copied_bench_file, max_bench_bytes));
  if (begun_with == bench.text) {
    return {};
  }
  return fail(ErrorCode::bad_file,
              fmt::format("{}: the run was begun with another bench file than {}; resume it with "
                          "its own, {}, or begin a new run",
                          folder.string(), bench.path.string(),
                          (folder / copied_bench_file).string()));
}

} // namespace

RunFolder::RunFolder(std::filesystem::path path, drivers::FileDescriptor lock, bool is_new)
    : path_(std::move(path)), lock_(std::move(lock)), is_new_(is_new),
      results_(std::make_unique<ResultKeeper>(path_ / result_file_name)) {}

RunFolder::~RunFolder() = default;

Expected<std::unique_ptr<RunFolder>> RunFolder::create(const std::filesystem::path& root,
                                                       const BenchFile& bench,
                                                       const std::string& name) {
  const fs::path folder = fs::absolute(root / bench.bench / name).lexically_normal();
  const fs::path unfinished = folder.string() + ".part";
  const FolderAccess access;
  if (const int cause = access.make_folders(folder.parent_path()); cause != 0) {
    return fail(cannot_make(folder.parent_path(), std::strerror(cause)));
  }
  if (const int cause = access.make_folder(unfinished); cause != 0) {
    return fail(cannot_make(unfinished, std::strerror(cause)));
  }
  auto lock = lock_folder(unfinished);
  const auto made =
      lock ? fill(unfinished, bench).and_then([&] { return take_name(unfinished, folder); })
           : Expected<void>(fail(lock.error()));
  if (!made) {
    std::error_code ignored;
    fs::remove_all(unfinished, ignored);
    return fail(made.error());
  }
  ::fsync(open_folder(folder.parent_path()).number());
  return std::unique_ptr<RunFolder>(new RunFolder(folder, std::move(*lock), true));
}

Expected<std::unique_ptr<RunFolder>> RunFolder::reopen(const std::filesystem::path& root,
                                                       const BenchFile& bench,
                                                       const std::string& run) {
  const fs::path newest = find_run_folder(root, bench.bench, run);
  if (newest.empty()) {
    return std::unique_ptr<RunFolder>();
  }
  DYNCAL_TRY(check_same_bench(newest, bench));
  DYNCAL_TRY(auto lock, lock_folder(newest));
  return std::unique_ptr<RunFolder>(new RunFolder(newest, std::move(lock), false));
}

std::filesystem::path RunFolder::recording_path() const {
  fs::path path = path_ / recording_file_name;
  for (int number = 2; fs::exists(path); ++number) {
    path = path_ / fmt::format("recording-{}.mcap", number);
  }
  return path;
}

std::uint64_t RunFolder::free_bytes() const {
  return free_on_disk(path_);
}

Expected<void> RunFolder::check_room(const SpaceEstimate& need) const {
  return check_free(path_, need.bytes(),
                    need.recording_bytes > 0 ? "the run and its recording need"
                                             : "the results of the run need");
}

Expected<void> RunFolder::finish(const RunOutcome& outcome) {
  DYNCAL_TRY(results_->finish(outcome));
  const auto drawn = write_figures(outcome, path_ / figures_folder_name);
  return drawn ? Expected<void>{} : fail(drawn.error());
}

void RunFolder::discard() {
  results_->stop();
  if (!is_new_) {
    return;
  }
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  fs::remove(path_.parent_path(), ignored); // of the bench, if it was the only one
}

std::filesystem::path find_run_folder(const std::filesystem::path& root, const std::string& bench,
                                      const std::string& run) {
  std::error_code unknown;
  std::pair<std::string, fs::path> newest; // by when it began
  const fs::path folders = fs::absolute(root / bench).lexically_normal();
  for (const auto& entry : fs::directory_iterator(folders, unknown)) {
    const auto found = fs::is_directory(entry.symlink_status(unknown))
                           ? run_of_folder(entry.path().filename().string(), run)
                           : std::nullopt;
    if (found) {
      newest = std::max(newest, std::pair(found->start, entry.path()));
    }
  }
  return newest.second;
}

std::filesystem::path run_path(const std::filesystem::path& typed) {
  std::error_code unknown;
  const fs::path path = fs::absolute(typed, unknown).lexically_normal();
  if (fs::exists(path, unknown) || !path.has_filename()) {
    return typed;
  }
  const fs::path bench = path.parent_path();
  const fs::path newest =
      find_run_folder(bench.parent_path(), bench.filename().string(), path.filename().string());
  return newest.empty() ? typed : newest;
}

bool is_in_use(const std::filesystem::path& run_folder) {
  const FileDescriptor folder = open_folder(run_folder);
  return folder.is_open() && ::flock(folder.number(), LOCK_SH | LOCK_NB) != 0;
}

} // namespace dyncal::inline records
