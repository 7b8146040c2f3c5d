#include "services/run/bench_queue.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;

class BenchQueueTest : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  bus::Participant other_ = network_.join("other");
  bus::Participant own_ = network_.join("own");
  bus::Writer<wire::Measurement> writer_ = other_.writer(bus::topics::measurement, "b").value();
  BenchQueue queue_ = BenchQueue::open(own_, clock_, "b").value();
  std::vector<std::string> phases_;
  std::stop_source stop_;

  void publish(wire::MeasurementState state, const std::string& run = "r1",
               const std::string& conductor = "lab-pc:12") {
    wire::Measurement measurement;
    measurement.bench("b");
    measurement.run(run);
    measurement.conductor(conductor);
    measurement.state(state);
    writer_.write(measurement);
  }
  // Repeated as a run does, until `end`.
  void run_until(std::chrono::nanoseconds end, wire::MeasurementState last) {
    for (auto at = 0ns; at < end; at += 2s) {
      clock_.at(at, [this] { publish(wire::MEASUREMENT_RUNNING); });
    }
    if (last != wire::MEASUREMENT_RUNNING) {
      clock_.at(end, [this, last] { publish(last); });
    }
  }
  Expected<void> wait() {
    return queue_.wait_until_free([this](const std::string& phase) { phases_.push_back(phase); },
                                  stop_.get_token());
  }
};

TEST_F(BenchQueueTest, AFreeBenchIsHadAfterListeningForAWhile) {
  EXPECT_TRUE(wait());
  EXPECT_GE(clock_.elapsed(), BenchQueue::listening_time);
  EXPECT_LE(clock_.elapsed(), BenchQueue::listening_time + 200ms);
}

TEST_F(BenchQueueTest, TheEndOfTheOtherRunIsWaitedForAndItsNameShown) {
  run_until(300s, wire::MEASUREMENT_DONE);
  EXPECT_TRUE(wait());
  EXPECT_EQ(clock_.elapsed(), 300s);
  EXPECT_THAT(phases_, testing::Contains("waiting for the end of run 'r1' of lab-pc:12"));
}

TEST_F(BenchQueueTest, ARunThatHasDiedIsWaitedForNoLongerThanTheAnalysisDoes) {
  run_until(20s, wire::MEASUREMENT_RUNNING); // its last message comes at 18 s
  EXPECT_TRUE(wait());
  EXPECT_GT(clock_.elapsed(), 18s + BenchQueue::alive_limit);
  EXPECT_LE(clock_.elapsed(), 18s + BenchQueue::alive_limit + 400ms);
}

TEST_F(BenchQueueTest, ARunThatWasPlannedMeanwhileIsWaitedForToo) {
  run_until(10s, wire::MEASUREMENT_ABORTED);
  clock_.at(9s, [this] { publish(wire::MEASUREMENT_PLANNED, "r2"); });
  clock_.at(12s, [this] { publish(wire::MEASUREMENT_ABORTED, "r2"); });
  EXPECT_TRUE(wait());
  EXPECT_EQ(clock_.elapsed(), 12s);
}

TEST_F(BenchQueueTest, OneThatHasEndedLongAgoIsNone) {
  publish(wire::MEASUREMENT_DONE);
  EXPECT_FALSE(queue_.taken_by());
  publish(wire::MEASUREMENT_PLANNED, "r2", "");
  EXPECT_EQ(queue_.taken_by(), "run 'r2'");
}

TEST_F(BenchQueueTest, ARunThatLivesIsHeardWithinItsListeningTime) {
  clock_.at(2s, [this] { publish(wire::MEASUREMENT_RUNNING); });
  EXPECT_EQ(queue_.listen(stop_.get_token()), "run 'r1' of lab-pc:12");
  EXPECT_EQ(clock_.elapsed(), 2s);
}

TEST_F(BenchQueueTest, OfADeadRunNothingIsHeard) {
  EXPECT_FALSE(queue_.listen(stop_.get_token()));
  EXPECT_GE(clock_.elapsed(), BenchQueue::listening_time);
}

TEST_F(BenchQueueTest, AStopEndsTheWaiting) {
  run_until(300s, wire::MEASUREMENT_DONE);
  clock_.at(7s, [this] { stop_.request_stop(); });
  EXPECT_EQ(wait().error().code, ErrorCode::interrupted);
  EXPECT_LE(clock_.elapsed(), 7s + 200ms);
}

} // namespace
} // namespace dyncal::inline run
