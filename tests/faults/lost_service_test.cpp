// A service that dies or ends in the middle of a run: the run switches the output off, says which
// one it waits for, and keeps what was measured when it is not waited for.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"
#include "tests/system/test_folder.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

struct Loss {
  std::string program;
  int signal;
  std::string says;
};

std::string loss_name(const testing::TestParamInfo<Loss>& loss) {
  return loss.param.program.substr(std::string("dyncal-").size()) +
         (loss.param.signal == SIGKILL ? "_killed" : "_ended");
}

class LostService : public testing::TestWithParam<Loss> {};

TEST_P(LostService, IsNamedAndWaitedForAndWhatWasMeasuredIsKept) {
  const auto folder = fresh_folder_of_this_test();
  ProgramRun demo("dyncal", {"demo", "--output", folder / "files"}, folder);
  ASSERT_TRUE(demo.wait_for_error_text("step 6 of 51", patience)) << demo.errors();
  ASSERT_TRUE(demo.send_to_child(GetParam().program, GetParam().signal));
  EXPECT_TRUE(demo.wait_for_error_text(GetParam().says, patience)) << demo.errors();
  EXPECT_TRUE(demo.wait_for_error_text("up to 120 s (the output is off)", patience))
      << demo.errors();
  demo.send(SIGINT);
  const auto status = demo.wait(patience);
  ASSERT_TRUE(status) << "still running\n" << demo.errors();
  EXPECT_NE(*status, 0);
  EXPECT_THAT(demo.errors(), HasSubstr("of 51 steps were measured and kept"));
  const auto result = read_json(folder / "files" / "result.json");
  ASSERT_FALSE(result.is_discarded());
  EXPECT_GE(result["points"].size(), 9U); // of the nine channels of one step at the least
}

INSTANTIATE_TEST_SUITE_P(EachService, LostService,
                         testing::Values(Loss{"dyncal-dau", SIGKILL, "source 'dau' of bench"},
                                         Loss{"dyncal-acs", SIGKILL, "source 'acs' of bench"},
                                         Loss{"dyncal-acs", SIGTERM, "has ended before the run"},
                                         Loss{"dyncal-analysis", SIGKILL, "has gone silent"}),
                         loss_name);

} // namespace
} // namespace dyncal::tests
