// Owns one file descriptor of the operating system and closes it.
//
// Move only; the object that is moved from owns nothing. A descriptor that is not open has the
// number -1. Errors of close() are not reported: nothing that was received depends on them. One
// thread at a time.
#pragma once

#include <utility>

namespace dyncal::drivers {

class FileDescriptor {
public:
  explicit FileDescriptor(int number = -1) : number_(number) {}
  ~FileDescriptor() { reset(); }
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept;
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;

  // Closes it now; assigning another descriptor does the same to the one held before.
  void reset();
  [[nodiscard]] int number() const { return number_; }
  [[nodiscard]] bool is_open() const { return number_ >= 0; }

private:
  int number_;
};

} // namespace dyncal::drivers
