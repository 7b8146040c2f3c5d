#include "services/live/limits.hpp"

#include <gtest/gtest.h>

namespace dyncal::services::live {
namespace {

TEST(Bounded, LeavesShortTextsAlone) {
  EXPECT_EQ(bounded("<b>acc-1</b>"), "<b>acc-1</b>");
}

TEST(Bounded, EndsBeforeALetterThatDoesNotFit) {
  const std::string text = std::string(max_text_bytes - 1, 'a') + "\u00e4\u00e4";
  EXPECT_EQ(bounded(text), std::string(max_text_bytes - 1, 'a'));
  EXPECT_EQ(bounded(std::string(5000, 'x')).size(), max_text_bytes);
}

TEST(Bounded, EndsForTextThatIsNoUtf8) {
  EXPECT_EQ(bounded(std::string(5000, '\x80')), "");
}

} // namespace
} // namespace dyncal::services::live
