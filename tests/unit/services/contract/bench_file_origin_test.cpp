#include "services/contract/bench_file_origin.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline contract {
namespace {

const std::string settings = "channels.Data_11 = 'sync'\n"
                             "driver = 'smartup'\n"
                             "listen = '0.0.0.0:7654'\n"
                             "sensor = '0xbccb0100'\n";

std::string with(const std::string& line, const std::string& other) {
  std::string text = settings;
  return text.replace(text.find(line), line.size(), other);
}

TEST(BenchFileOrigin, FindsNoDifferenceWhereThereIsNone) {
  EXPECT_FALSE(settings_difference(settings, settings));
}

TEST(BenchFileOrigin, DoesNotCompareWhatIsNotKnown) {
  EXPECT_FALSE(settings_difference("", settings));
  EXPECT_FALSE(settings_difference(settings, ""));
}

TEST(BenchFileOrigin, NamesKeyAndBothValues) {
  const auto difference =
      settings_difference(settings, with("sensor = '0xbccb0100'", "sensor = '0xdeadbeef'"));
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->key, "sensor");
  EXPECT_EQ(difference->service_value, "'0xbccb0100'");
  EXPECT_EQ(difference->run_value, "'0xdeadbeef'");
}

TEST(BenchFileOrigin, NamesAKeyThatOnlyOneOfThemHas) {
  const auto more = settings_difference(settings + "serial = '4711'\n", settings);
  ASSERT_TRUE(more);
  EXPECT_EQ(more->key, "serial");
  EXPECT_EQ(more->run_value, "");
  const auto fewer = settings_difference(with("channels.Data_11 = 'sync'\n", ""), settings);
  ASSERT_TRUE(fewer);
  EXPECT_EQ(fewer->key, "channels.Data_11");
  EXPECT_EQ(fewer->service_value, "");
  EXPECT_EQ(fewer->run_value, "'sync'");
}

TEST(BenchFileOrigin, RefusesInOneSentenceWithWhatToDo) {
  EXPECT_EQ(refusal({"sensor", "'0xbccb0100'", "'0xdeadbeef'"}, "acc-1", "dau", "lab-2"),
            "the service of source 'dau' of bench 'acc-1' on lab-2 has read another bench file "
            "than this run: key 'sources.dau.sensor' is '0xbccb0100' there and '0xdeadbeef' here; "
            "restart the service with this bench file, or correct the file");
  EXPECT_NE(refusal({"serial", "", "'4711'"}, "acc-1", "dau", "").find("is nothing there"),
            std::string::npos);
}

} // namespace
} // namespace dyncal::inline contract
