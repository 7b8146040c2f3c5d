// A bench whose evaluation takes long beside one whose does not, at one analysis service.
#include <chrono>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/programs/analysis/analysis_service.hpp"
#include "tests/patience.hpp"
#include "tests/unit/services/evaluation/costly_run.hpp"
#include "tests/unit/services/programs/analysis/played_sources.hpp"

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;

// Its run has ended in its sources' samples; they go on to send.
template <class Run>
class PlayedBench {
public:
  PlayedBench(bus::MemoryNetwork& network, const Run& run)
      : run_(run), acs_(network, run.acs_description()), dau_(network, run.dau_description()),
        published_(network, "operator of " + acs_.bench(), acs_.bench()),
        runner_(network.join("runner of " + acs_.bench())),
        measurements_(runner_
                          .writer<wire::Measurement>(bus::topics::measurement, bus::Profile::state,
                                                     acs_.bench())
                          .value()) {
    for (tests::PlayedSource* source : {&acs_, &dau_}) {
      source->describe();
      source->report(wire::SOURCE_RUNNING);
    }
  }

  void publish(const std::string& run, wire::MeasurementState state) {
    wire::Measurement measurement = run_.measurement();
    measurement.run(run);
    measurement.state(state);
    measurements_.write(measurement);
  }
  void send() {
    acs_.send(run_.acs_blocks());
    dau_.send(run_.dau_blocks());
  }
  void go_on() {
    for (tests::PlayedSource* source : {&acs_, &dau_}) {
      source->answer_commands();
      source->answer_requests();
      source->send_nothing();
    }
  }
  std::vector<wire::ServiceStatus> statuses(const std::string& run) {
    std::vector<wire::ServiceStatus> of_run;
    for (const wire::ServiceStatus& status : published_.statuses()) {
      if (status.run().to_string() == run) {
        of_run.push_back(status);
      }
    }
    return of_run;
  }
  wire::ServiceStatus newest_status(const std::string& run) {
    const auto all = statuses(run);
    return all.empty() ? wire::ServiceStatus() : all.back();
  }
  const std::vector<wire::CalibrationResult>& results() { return published_.results(); }

private:
  Run run_;
  tests::PlayedSource acs_, dau_;
  tests::PublishedByAnalysis published_;
  bus::Participant runner_;
  bus::Writer<wire::Measurement> measurements_;
};

class CostlyEvaluationTest : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  PlayedBench<tests::CostlyRun> costly_{network_, tests::CostlyRun("costly")};
  PlayedBench<tests::SyntheticRun> other_{network_, {.steps = {{"40", 10.0}}}};
  std::unique_ptr<AnalysisService> service_ =
      AnalysisService::create(network_.join("analysis"),
                              {.service = "analysis@test:1", .host = "test", .dds = "memory"},
                              clock_)
          .value();

  CostlyEvaluationTest() {
    clock_.every(100ms, [this] {
      costly_.go_on();
      other_.go_on();
    });
  }
  void serve_for(std::chrono::nanoseconds time) {
    std::stop_source stop;
    clock_.at(clock_.elapsed() + time, [&] { stop.request_stop(); });
    service_->serve(stop.get_token());
  }
  template <class Bench>
  void begin(Bench& bench, const std::string& run) {
    bench.publish(run, wire::MEASUREMENT_PLANNED);
    serve_for(1s);
    ASSERT_EQ(bench.newest_status(run).arm(), wire::ARM_ARMED);
    bench.publish(run, wire::MEASUREMENT_RUNNING);
    bench.send();
    serve_for(200ms);
  }
};

TEST_F(CostlyEvaluationTest, StopsNoOtherBench) {
  begin(costly_, "r1");
  EXPECT_TRUE(costly_.results().empty());
  begin(other_, "r1");
  EXPECT_EQ(other_.results().size(), 1U);
  EXPECT_EQ(other_.newest_status("r1").arm(), wire::ARM_FINISHED);

  for (int second = 0; second < 10; ++second) {
    const std::size_t before = costly_.statuses("r1").size();
    serve_for(1s);
    EXPECT_GT(costly_.statuses("r1").size(), before);
  }
  EXPECT_EQ(costly_.newest_status("r1").arm(), wire::ARM_ARMED);
  EXPECT_EQ(costly_.newest_status("r1").health(), wire::HEALTH_OK);
  EXPECT_THAT(costly_.newest_status("r1").message(),
              testing::StartsWith("evaluating a step, for "));
  EXPECT_TRUE(costly_.results().empty());
}

TEST_F(CostlyEvaluationTest, DoesNotHoldAServiceThatEnds) {
  begin(costly_, "r1");
  ASSERT_TRUE(costly_.results().empty());
  const auto ends = std::chrono::steady_clock::now();
  service_.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - ends, 2s);
}

TEST_F(CostlyEvaluationTest, OfARunThatHasDiedDoesNotHoldItsBench) {
  begin(costly_, "r1");
  ASSERT_TRUE(costly_.results().empty());
  costly_.publish("r2", wire::MEASUREMENT_PLANNED);
  serve_for(RunSession::bench_limit + 1s); // in an instant
  const auto deadline = std::chrono::steady_clock::now() + 2s;
  while (costly_.newest_status("r2").arm() != wire::ARM_ARMED &&
         std::chrono::steady_clock::now() < deadline) {
    serve_for(100ms);
  }
  EXPECT_EQ(costly_.newest_status("r2").arm(), wire::ARM_ARMED);
  EXPECT_EQ(costly_.newest_status("r1").arm(), wire::ARM_FINISHED);
  ASSERT_EQ(costly_.results().size(), tests::CostlyRun::channels);
  const wire::CalibrationResult& last = costly_.results().back();
  EXPECT_TRUE(last.valid());
  EXPECT_TRUE(last.monte_carlo().empty());
  ASSERT_EQ(last.flags().size(), 1U);
  EXPECT_THAT(last.flags().front(), testing::HasSubstr("drawing was stopped before its end"));
}

} // namespace
} // namespace dyncal::inline programs
