#include "services/checks/doctor/send_queues.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline checks::doctor {
namespace {

// With a queue that drops: unheard_analysis_test.py of tests/faults.
TEST(SendQueues, HasThatOfTheLoopbackInterface) {
  const auto queues = send_queues();
  ASSERT_TRUE(queues.contains("lo"));
  EXPECT_EQ(queues.at("lo").dropped, 0U);
}

} // namespace
} // namespace dyncal::inline checks::doctor
