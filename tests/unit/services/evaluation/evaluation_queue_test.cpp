#include "services/evaluation/evaluation_queue.hpp"

#include <atomic>
#include <latch>
#include <thread>

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

std::vector<StepResult> result_of_step(std::uint32_t step) {
  StepResult result;
  result.step = step;
  return {result};
}

TEST(EvaluationQueue, EvaluatesInTheCallersThreadWhenToldTo) {
  EvaluationQueue queue(0);
  std::thread::id thread;
  queue.begin([&](const std::stop_token&) {
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
  queue.begin([&](const std::stop_token&) {
    second_is_done.wait();
    return result_of_step(1);
  });
  queue.begin([&](const std::stop_token&) {
    second_is_done.count_down();
    return result_of_step(2);
  });
  queue.begin([](const std::stop_token&) { return result_of_step(3); });
  const auto results = queue.take_all();
  ASSERT_EQ(results.size(), 3U);
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(results[i].step, i + 1);
  }
}

TEST(EvaluationQueue, HoldsBackResultsThatAreAheadOfOneUnderWay) {
  EvaluationQueue queue(2);
  std::latch go(1);
  queue.begin([&](const std::stop_token&) {
    go.wait();
    return result_of_step(1);
  });
  queue.begin([](const std::stop_token&) { return result_of_step(2); });
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
    queue.begin([&, step](const std::stop_token&) {
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

TEST(EvaluationQueue, HasRoomAgainWhenTheOldestHasEnded) {
  EvaluationQueue queue(1);
  EXPECT_TRUE(queue.has_room());
  EXPECT_TRUE(queue.is_idle());
  std::latch go(1);
  queue.begin([&](const std::stop_token&) {
    go.wait();
    return result_of_step(1);
  });
  EXPECT_FALSE(queue.has_room());
  EXPECT_FALSE(queue.is_idle());
  EXPECT_TRUE(queue.take_finished().empty());
  go.count_down();
  while (!queue.is_idle()) {
    std::this_thread::yield();
  }
  EXPECT_TRUE(queue.has_room());
  queue.begin([](const std::stop_token&) { return result_of_step(2); });
  const auto results = queue.take_all();
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].step, 1U);
  EXPECT_EQ(results[1].step, 2U);
}

TEST(EvaluationQueue, AlwaysHasRoomInTheCallersThread) {
  EvaluationQueue queue(0);
  queue.begin([](const std::stop_token&) { return result_of_step(1); });
  EXPECT_TRUE(queue.has_room());
  EXPECT_TRUE(queue.is_idle());
}

// One that only ends when it is asked to.
std::vector<StepResult> until_stopped(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::this_thread::yield();
  }
  return result_of_step(1);
}

TEST(EvaluationQueue, EndsWhatIsUnderWayWhenItIsDropped) {
  EvaluationQueue queue(2);
  queue.begin(until_stopped);
  queue.begin(until_stopped);
  EXPECT_FALSE(queue.is_idle());
}

TEST(EvaluationQueue, KeepsTheResultsOfWhatItStops) {
  EvaluationQueue queue(1);
  queue.begin(until_stopped);
  queue.stop();
  queue.begin(until_stopped);
  EXPECT_EQ(queue.take_all().size(), 2U);
}

} // namespace
} // namespace dyncal::inline evaluation
