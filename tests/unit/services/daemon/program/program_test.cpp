// What others have written, in a program's log and in its last line.
#include "services/daemon/program/program.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include "services/base/printable_text.hpp"
#include "services/daemon/program/log.hpp"

namespace dyncal::inline daemon {
namespace {

std::string hostile() {
  std::string text = "analysis";
  while (text.size() < 100'000) {
    text += "\x1b[2J\r\nok\xff";
  }
  return text + "; end it there";
}

void expect_one_short_line(const std::string& written) {
  EXPECT_EQ(std::count(written.begin(), written.end(), '\n'), 1) << written.substr(0, 200);
  EXPECT_LT(written.size(), max_line_bytes + 100); // time and name stand before it
  EXPECT_EQ(written.find_first_of("\x1b\r\xff"), std::string::npos);
  EXPECT_NE(written.find("analysis"), std::string::npos);
  EXPECT_NE(written.find("; end it there\n"), std::string::npos) << "the remedy";
}

TEST(ReportError, WritesOneShortLineWhateverOthersHaveSent) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(report_error({ErrorCode::device, hostile()}), 1);
  expect_one_short_line(testing::internal::GetCapturedStderr());
}

TEST(Log, WritesOneShortLineWhateverOthersHaveSent) {
  set_up_log("dyncal-acs", LogWriting::at_once);
  testing::internal::CaptureStderr();
  spdlog::warn("{}", hostile());
  spdlog::default_logger()->flush();
  expect_one_short_line(testing::internal::GetCapturedStderr());
}

} // namespace
} // namespace dyncal::inline daemon
