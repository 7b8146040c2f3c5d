#include "drivers/files/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace dyncal::drivers::files {
namespace {

tl::unexpected<Error> unreadable(const std::filesystem::path& path) {
  return fail(ErrorCode::not_found,
              path.string() +
                  ": cannot read this file; does it exist, is it a file, and may you read it?");
}

} // namespace

Expected<MappedFile> MappedFile::open(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    return unreadable(path);
  }
  MappedFile file;
  struct stat status {};
  const bool regular = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  if (regular && status.st_size > 0) {
    file.size_ = static_cast<std::size_t>(status.st_size);
    file.data_ = ::mmap(nullptr, file.size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
  }
  ::close(descriptor);
  if (!regular || file.data_ == MAP_FAILED) {
    file.data_ = nullptr;
    return unreadable(path);
  }
  if (file.data_ != nullptr) {
    ::madvise(file.data_, file.size_, MADV_SEQUENTIAL);
  }
  return file;
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MappedFile::~MappedFile() {
  if (data_ != nullptr) {
    ::munmap(data_, size_);
  }
}

} // namespace dyncal::drivers::files
