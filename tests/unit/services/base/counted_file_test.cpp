#include "services/base/counted_file.hpp"

#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::services {
namespace {

std::string text_of_size(std::size_t size) {
  std::string text;
  for (std::size_t i = 0; i < size; ++i) {
    text.push_back(static_cast<char>(i * 31 + i / 8191));
  }
  return text;
}

TEST(CountedFile, GivesTheBytesOfTheFileAndCountsThem) {
  const tests::TemporaryFolder folder;
  for (const std::size_t size : {0, 1, 8191, 8192, 100'000, 3'000'001}) {
    const std::string text = text_of_size(size);
    const auto path = folder.write("text", text);
    ByteCount bytes(nullptr, "reading", bytes_of_file(path));
    CountedFile file(path, bytes);
    ASSERT_TRUE(file.stream());
    const std::string read{std::istreambuf_iterator<char>(file.stream()), {}};
    EXPECT_EQ(read, text);
    EXPECT_EQ(bytes.done(), size);
  }
}

TEST(CountedFile, CountsWhileItIsRead) {
  const tests::TemporaryFolder folder;
  const auto path = folder.write("text", text_of_size(5'000'000));
  const auto count = std::make_shared<WorkCount>("opening");
  ByteCount bytes(count, "reading", bytes_of_file(path));
  CountedFile file(path, bytes);
  std::size_t read = 0;
  for (std::istreambuf_iterator<char> next(file.stream()), end; next != end; ++next) {
    ++read;
    if (read % 100'000 == 0) {
      const double ahead = static_cast<double>(bytes.done()) - static_cast<double>(read);
      ASSERT_GE(ahead, 0.0);
      ASSERT_LE(ahead, 10'000.0); // a buffer
    }
  }
  EXPECT_EQ(count->state().done, 5U);
}

TEST(CountedFile, SeveralFilesAddUp) {
  const tests::TemporaryFolder folder;
  const auto path = folder.write("text", text_of_size(1'000'000));
  const auto count = std::make_shared<WorkCount>("opening");
  ByteCount bytes(count, "reading", 2 * bytes_of_file(path));
  for (int i = 0; i < 2; ++i) {
    CountedFile file(path, bytes);
    const std::string read{std::istreambuf_iterator<char>(file.stream()), {}};
    EXPECT_EQ(read.size(), 1'000'000U);
    EXPECT_EQ(count->state().done, static_cast<std::size_t>(i + 1));
  }
}

TEST(CountedFile, FailsWhereThereIsNone) {
  const tests::TemporaryFolder folder;
  ByteCount bytes;
  EXPECT_FALSE(CountedFile(folder.path() / "none", bytes).stream());
}

} // namespace
} // namespace dyncal::services
