#include "services/web/laboratory_answers.hpp"

#include <gtest/gtest.h>

namespace dyncal::services::web {
namespace {

TEST(BenchAddress, DividesNameAndPart) {
  const auto divided = [](const char* path) {
    const auto address = bench_address(path);
    return address ? address->bench + "|" + address->part : "none";
  };
  EXPECT_EQ(divided("/api/bench/acc-1"), "acc-1|");
  EXPECT_EQ(divided("/api/bench/acc-1/run"), "acc-1|run");
  EXPECT_EQ(divided("/api/bench/a/b/signal"), "a/b|signal");
  EXPECT_EQ(divided("/api/bench/run"), "run|");
  EXPECT_EQ(divided("/api/bench/acc-1/other"), "acc-1/other|");
  EXPECT_EQ(divided("/api/bench/"), "none");
  EXPECT_EQ(divided("/api/laboratory"), "none");
}

} // namespace
} // namespace dyncal::services::web
