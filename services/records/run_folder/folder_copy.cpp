#include "services/records/run_folder/folder_copy.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include <fmt/core.h>

#include "drivers/link/file_descriptor.hpp"
#include "services/base/output_file.hpp"
#include "services/bench/file/named_files.hpp"

namespace dyncal::inline records {
namespace {

namespace fs = std::filesystem;
using drivers::FileDescriptor;

struct Copy {
  fs::path from;
  fs::path to; // relative to the run folder
};

std::vector<Copy> copies_of(const BenchFile& bench) {
  std::vector<Copy> copies;
  std::error_code unknown;
  for (const NamedFile& file : bench.named_files) {
    const fs::path place = place_of_copy(file.name);
    if (fs::is_regular_file(file.path, unknown)) {
      copies.push_back({file.path, place});
    }
    if (!fs::is_directory(file.path, unknown)) {
      continue;
    }
    for (const auto& entry : fs::directory_iterator(file.path, unknown)) {
      if (entry.is_regular_file(unknown)) {
        copies.push_back({entry.path(), place / entry.path().filename()});
      }
    }
  }
  return copies;
}

Error not_copied(const Copy& copy, const fs::path& to, const std::string& reason) {
  return {ErrorCode::bad_file,
          fmt::format("{}: cannot be copied to {} ({}); choose another folder with --folder or "
                      "make room",
                      copy.from.string(), to.string(), reason)};
}

Expected<void> copy_file(const Copy& copy, const fs::path& folder) {
  const fs::path to = folder / copy.to;
  const fs::path unfinished = to.string() + ".part";
  std::error_code problem;
  fs::create_directories(to.parent_path(), problem);
  if (!problem) {
    fs::copy_file(copy.from, unfinished, fs::copy_options::overwrite_existing, problem);
  }
  if (problem) {
    return fail(not_copied(copy, to, problem.message()));
  }
  const FileDescriptor file(::open(unfinished.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open() || ::fsync(file.number()) != 0 ||
      ::rename(unfinished.c_str(), to.c_str()) != 0) {
    return fail(not_copied(copy, to, std::strerror(errno)));
  }
  return {};
}

} // namespace

Expected<void> copy_bench(const BenchFile& bench, const std::filesystem::path& folder) {
  if (auto written = write_output_file(folder / copied_bench_file, bench.text); !written) {
    return written;
  }
  for (const Copy& copy : copies_of(bench)) {
    if (auto copied = copy_file(copy, folder); !copied) {
      return copied;
    }
  }
  return {};
}

std::uint64_t bytes_of_bench(const BenchFile& bench) {
  std::uint64_t bytes = bench.text.size();
  std::error_code unknown;
  for (const Copy& copy : copies_of(bench)) {
    const auto size = fs::file_size(copy.from, unknown);
    bytes += unknown ? 0 : size;
  }
  return bytes;
}

} // namespace dyncal::inline records
