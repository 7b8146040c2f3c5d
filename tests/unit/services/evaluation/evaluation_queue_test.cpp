#include "services/evaluation/evaluation_queue.hpp"

#include <atomic>
#include <latch>
#include <thread>

#include <gtest/gtest.h>

namespace dyncal::services {
namespace {

std::vector<StepResult> result_of_step(std::uint32_t step) {
  StepResult result;
  result.step = step;
  return {result};
}

TEST(EvaluationQueue, EvaluatesInTheCallersThreadWhenToldTo) {
  EvaluationQueue queue(0);
  std::thread::id thread;
  queue.begin([&] {
    thread = std::this_thread::get_id();
    return result_of_step(1);
  });
  EXPECT_EQ(thread, std::this_thread::get_id());
  EXPECT_EQ(queue.take_finished().size(), 1U);
  EXPECT_TRUE(queue.take_all().empty());
}

TEST(EvaluationQueue, GivesResultsInTheOrderInWhichTheyWereBegun) {
  EvaluationQueue queue(2);
  std::latch second_is_done(1);
  queue.begin([&] {
    second_is_done.wait();
    return result_of_step(1);
  });
  queue.begin([&] {
    second_is_done.count_down();
    return result_of_step(2);
  });
  queue.begin([] { return result_of_step(3); });
  const auto results = queue.take_all();
  ASSERT_EQ(results.size(), 3U);
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(results[i].step, i + 1);
  }
}

TEST(EvaluationQueue, HoldsBackResultsThatAreAheadOfOneUnderWay) {
  EvaluationQueue queue(2);
  std::latch go(1);
  queue.begin([&] {
    go.wait();
    return result_of_step(1);
  });
  queue.begin([] { return result_of_step(2); });
  EXPECT_TRUE(queue.take_finished().empty());
  go.count_down();
  EXPECT_EQ(queue.take_all().size(), 2U);
}

TEST(EvaluationQueue, NeverRunsMoreAtOnceThanItMay) {
  constexpr int most = 3;
  EvaluationQueue queue(most);
  std::atomic<int> running = 0;
  std::atomic<int> seen = 0;
  for (std::uint32_t step = 0; step < 50; ++step) {
    queue.begin([&, step] {
      const int now = ++running;
      for (int before = seen; before < now && !seen.compare_exchange_weak(before, now);) {
      }
      std::this_thread::yield();
      --running;
      return result_of_step(step);
    });
  }
  EXPECT_EQ(queue.take_all().size(), 50U);
  EXPECT_LE(seen, most);
}

} // namespace
} // namespace dyncal::services
