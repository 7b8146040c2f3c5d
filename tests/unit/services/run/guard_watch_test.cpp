// When the operator of a run is told that nobody guards its exciter; no real time passes.
#include "services/run/guard_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Optional;

class GuardWatchTest : public testing::Test {
protected:
  void report(const std::string& generator, const std::string& failure = "",
              const std::string& service = "guard@lab-2:7") {
    wire::ServiceStatus status;
    status.service(service);
    status.host("lab-2");
    status.guarded_generator(generator);
    status.health(failure.empty() ? wire::HEALTH_OK : wire::HEALTH_FAILED);
    status.message(failure);
    watch_.take(status, now_);
  }
  std::optional<std::string> notice() { return watch_.notice(now_); }

  GuardWatch::Instant now_{1h};
  GuardWatch watch_{"acc-1", "192.0.2.7:5025", now_};
};

TEST_F(GuardWatchTest, SaysOnceThatThereIsNone) {
  now_ += GuardWatch::limit;
  EXPECT_EQ(notice(), std::nullopt);
  now_ += 1ms;
  EXPECT_THAT(notice(), Optional(HasSubstr("no dyncal-guard watches over the exciter of bench "
                                           "'acc-1': should this program, its host or its link "
                                           "fail, the exciter stays on; start dyncal-guard")));
  now_ += 1h;
  EXPECT_EQ(notice(), std::nullopt);
  report("192.0.2.7:5025");
  EXPECT_THAT(notice(), Optional(HasSubstr("watches over the exciter of bench 'acc-1' now")));
}

TEST_F(GuardWatchTest, SaysNothingWhereOneIsHeardAndTellsWhenItFallsSilent) {
  for (int i = 0; i < 20; ++i) {
    report("192.0.2.7:5025");
    EXPECT_EQ(notice(), std::nullopt);
    now_ += 1s;
  }
  now_ += 5s;
  EXPECT_THAT(notice(), Optional(HasSubstr("the dyncal-guard on lab-2 has gone silent")));
  EXPECT_EQ(notice(), std::nullopt);
}

TEST_F(GuardWatchTest, NamesOneOfAnotherGenerator) {
  report("192.0.2.8:5025");
  EXPECT_THAT(notice(), Optional(HasSubstr("switches off the generator at 192.0.2.8:5025, and "
                                           "this run drives the one at 192.0.2.7:5025")));
}

TEST_F(GuardWatchTest, TakesAnAddressOfTheLoopbackInterfaceForTheSame) {
  report("127.0.0.1:5025");
  now_ += 3s;
  EXPECT_EQ(notice(), std::nullopt);
}

TEST_F(GuardWatchTest, PassesOnThatAnOutputMayBeOn) {
  report("192.0.2.7:5025", "THE OUTPUT OF THE GENERATOR MAY BE ON");
  EXPECT_THAT(notice(), Optional(HasSubstr("on lab-2: THE OUTPUT OF THE GENERATOR MAY BE ON")));
  report("192.0.2.7:5025", "", "guard@lab-1:1"); // which can reach it, or has not tried
  EXPECT_EQ(notice(), std::nullopt) << "it stands";
}

TEST_F(GuardWatchTest, SaysNothingWhereThereIsNothingToGuard) {
  watch_ = GuardWatch("acc-1", "", now_);
  now_ += 1h;
  EXPECT_EQ(notice(), std::nullopt);
}

TEST_F(GuardWatchTest, PausesTheRunThatAGuardDoesNotHear) {
  wire::ServiceStatus status;
  status.service("guard@lab-2:7");
  status.host("lab-2");
  status.guarded_generator("192.0.2.7:5025");
  status.run("r1");
  watch_.take(status, now_);
  EXPECT_THAT(watch_.deafness("r1", now_), HasSubstr("on lab-2 does not hear this run"));
  EXPECT_EQ(watch_.deafness("r2", now_), "");
  EXPECT_NE(watch_.deafness("r1", now_ + 6s), "") << "its last word, and nobody else is there";
  now_ += 6s;
  status.service("guard@lab-2:8"); // the same program, started again
  status.run("");
  watch_.take(status, now_);
  EXPECT_EQ(watch_.deafness("r1", now_), "");
  status.service("guard@lab-2:7");
  status.run("r1");
  watch_.take(status, now_);
  EXPECT_NE(watch_.deafness("r1", now_), "") << "one of two is deaf";
  status.run("");
  watch_.take(status, now_);
  EXPECT_EQ(watch_.deafness("r1", now_), "");
  status.run("r1");
  status.guarded_generator("192.0.2.8:5025");
  watch_.take(status, now_);
  EXPECT_EQ(watch_.deafness("r1", now_), "") << "it guards another generator";
}

TEST_F(GuardWatchTest, PassesOverOtherServicesAndHoldsNoMoreThanItsBound) {
  wire::ServiceStatus status;
  for (int i = 0; i < 1000; ++i) {
    status.service("analysis@lab-1:" + std::to_string(i));
    watch_.take(status, now_);
  }
  report("192.0.2.7:5025"); // none of those has taken its place
  now_ += 1s;
  EXPECT_EQ(notice(), std::nullopt);
}

} // namespace
} // namespace dyncal::inline run
