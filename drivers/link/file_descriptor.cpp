#include "drivers/link/file_descriptor.hpp"

#include <unistd.h>

namespace dyncal::drivers {

FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
  if (this != &other) {
    reset();
    number_ = std::exchange(other.number_, -1);
  }
  return *this;
}

void FileDescriptor::reset() {
  if (number_ >= 0) {
    ::close(number_);
  }
  number_ = -1;
}

} // namespace dyncal::drivers
