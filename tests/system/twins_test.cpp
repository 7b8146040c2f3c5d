// Two services that play files under one source name: the run is refused before anything is
// measured, and both are named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

TEST(Twins, AreNamedAndKeepARunFromBeginning) {
  const auto folder = fresh_folder("twins");
  const auto bench = recorded_bench(folder, "bench-a", "5");
  Laboratory laboratory(folder);
  ProgramRun& analysis = laboratory.start("dyncal-analysis", {}, "cyclonedds");
  laboratory.start("dyncal-acs", {bench}, "cyclonedds");
  laboratory.start("dyncal-acs", {bench}, "cyclonedds");
  ASSERT_TRUE(analysis.wait_for_error_text("two services", patience)) << analysis.errors();
  ProgramRun& run = laboratory.start("dyncal", {"run", bench}, "cyclonedds");
  const auto status = run.wait(patience);
  ASSERT_TRUE(status);
  EXPECT_EQ(*status, 1);
  EXPECT_THAT(run.errors(),
              testing::ContainsRegex("two services [(][^ ]+:[0-9]+ and [^ ]+:[0-9]+[)] send as "
                                     "source '(acs|dau)' of bench 'bench-a'; end one of them, or "
                                     "give it another name"));
  EXPECT_THAT(run.errors(), testing::Not(testing::HasSubstr("step 1 of")));
}

} // namespace
} // namespace dyncal::tests
