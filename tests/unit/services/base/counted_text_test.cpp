#include "services/base/counted_text.hpp"

#include <memory>
#include <string>

#include <gtest/gtest.h>

namespace dyncal::inline base {
namespace {

std::string text_of_size(std::size_t size) {
  std::string text;
  for (std::size_t i = 0; i < size; ++i) {
    text.push_back(static_cast<char>(i * 31 + i / 8191));
  }
  return text;
}

TEST(CountedText, GivesTheBytesOfTheTextAndCountsThemInParts) {
  constexpr std::size_t part = 65'536;
  for (const std::size_t size : {0, 1, 65'535, 65'536, 3'000'001}) {
    const std::string text = text_of_size(size);
    ByteCount bytes(nullptr, "reading", size);
    const CountedText counted(text, bytes);
    std::string read;
    for (const char letter : counted) {
      read.push_back(letter);
      ASSERT_LE(bytes.done(), read.size());
      ASSERT_LT(read.size() - bytes.done(), part + 1);
    }
    EXPECT_EQ(read, text);
    EXPECT_EQ(bytes.done(), size);
  }
}

TEST(CountedText, SeveralTextsAddUp) {
  const std::string text = text_of_size(1'000'000);
  const auto count = std::make_shared<WorkCount>("opening");
  ByteCount bytes(count, "reading", 2 * text.size());
  for (int i = 0; i < 2; ++i) {
    const CountedText counted(text, bytes);
    std::size_t read = 0;
    for (auto next = counted.begin(); next != counted.end(); ++next) {
      ++read;
    }
    EXPECT_EQ(read, text.size());
  }
  EXPECT_GT(bytes.done(), 1'900'000U);
}

} // namespace
} // namespace dyncal::inline base
