#include "drivers/link/file_descriptor.hpp"

#include <array>
#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace dyncal::drivers {
namespace {

bool is_open_in_the_system(int number) {
  return fcntl(number, F_GETFD) >= 0;
}

class FileDescriptors : public testing::Test {
protected:
  FileDescriptors() {
    std::array<int, 2> ends{};
    EXPECT_EQ(pipe(ends.data()), 0);
    first = ends[0];
    second = ends[1];
  }

  int first = -1;
  int second = -1;
};

TEST_F(FileDescriptors, CloseWhatTheyOwnWhenTheyAreDestroyed) {
  {
    const FileDescriptor reading(first);
    const FileDescriptor writing(second);
    EXPECT_TRUE(reading.is_open());
    EXPECT_EQ(reading.number(), first);
    EXPECT_TRUE(is_open_in_the_system(first));
  }
  EXPECT_FALSE(is_open_in_the_system(first));
  EXPECT_FALSE(is_open_in_the_system(second));
}

TEST_F(FileDescriptors, HandOverWhatTheyOwnWhenTheyAreMoved) {
  FileDescriptor reading(first);
  FileDescriptor writing(second);
  FileDescriptor moved(std::move(reading));
  EXPECT_FALSE(reading.is_open()); // NOLINT(bugprone-use-after-move): owning nothing is promised
  EXPECT_TRUE(is_open_in_the_system(first));

  moved = std::move(writing);
  EXPECT_FALSE(is_open_in_the_system(first)) << "the descriptor held before must be closed at once";
  EXPECT_EQ(moved.number(), second);
  EXPECT_TRUE(is_open_in_the_system(second));
}

TEST_F(FileDescriptors, CloseOnceWhenReset) {
  FileDescriptor reading(first);
  FileDescriptor writing(second);
  reading.reset();
  EXPECT_FALSE(reading.is_open());
  EXPECT_FALSE(is_open_in_the_system(first));
  const FileDescriptor same_number(dup(second));
  EXPECT_EQ(same_number.number(), first) << "the system gives the lowest free number";
  reading.reset();
  EXPECT_TRUE(is_open_in_the_system(first));
}

} // namespace
} // namespace dyncal::drivers
