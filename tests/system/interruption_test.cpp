// Ctrl-C in the middle of a run ends the excitation, keeps what was measured, and says so.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

TEST(Interruption, EndsTheExcitationKeepsWhatWasMeasuredAndSaysSo) {
  const auto folder = fresh_folder("interruption");
  ProgramRun demo("dyncal", {"demo", "--output", folder / "files"}, folder);
  ASSERT_TRUE(demo.wait_for_error_text("step 6 of 51", patience)) << demo.errors();
  demo.send(SIGINT);
  const auto status = demo.wait(patience);
  ASSERT_TRUE(status);
  EXPECT_EQ(*status, 130);
  EXPECT_THAT(demo.errors(), HasSubstr("interrupted: the excitation is off"));
  const auto result = read_json(folder / "files" / "result.json");
  ASSERT_FALSE(result.is_discarded());
  EXPECT_TRUE(result["interrupted"].get<bool>());
  EXPECT_GE(result["points"].size(), 5U);
  EXPECT_GE(result["transfer_function"].size(), 5U);
}

} // namespace
} // namespace dyncal::tests
