// The analysis service as a bench meets it, on the memory bus and in stepped time.
#include "services/programs/analysis/analysis_service.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/base/version.hpp"
#include "tests/unit/services/programs/analysis/played_sources.hpp"

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;
using tests::PlayedSource;

class AnalysisServiceTest : public testing::Test {
protected:
  tests::SyntheticRun synthetic_{.steps = {{"40", 10.0}}};
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  PlayedSource acs_{network_, synthetic_.acs_description()};
  PlayedSource dau_{network_, synthetic_.dau_description()};
  tests::PublishedByAnalysis published_{network_};
  bus::Participant runner_ = network_.join("runner");
  bus::Writer<wire::Measurement> measurements_ = measurement_writer(tests::played_bench);
  std::unique_ptr<AnalysisService> service_ =
      AnalysisService::create(network_.join("analysis"),
                              {.service = "analysis@test:1", .host = "test", .dds = "memory"},
                              clock_)
          .value();
  AnalysisFigures figures_; // the newest

  bus::Writer<wire::Measurement> measurement_writer(const std::string& bench) {
    return runner_.writer<wire::Measurement>(bus::topics::measurement, bus::Profile::state, bench)
        .value();
  }
  wire::Measurement measurement(const std::string& run, wire::MeasurementState state) const {
    wire::Measurement measurement = synthetic_.measurement();
    measurement.run(run);
    measurement.state(state);
    measurement.conductor("lab-pc:17");
    return measurement;
  }
  void publish(const std::string& run, wire::MeasurementState state) {
    measurements_.write(measurement(run, state));
  }
  void serve_for(std::chrono::nanoseconds time) {
    std::stop_source stop;
    clock_.at(clock_.elapsed() + time, [&] { stop.request_stop(); });
    service_->serve(stop.get_token(),
                    [this](const AnalysisFigures& figures) { figures_ = figures; });
  }
  // Sources that are there, answer, and send without end.
  void play_sources() {
    for (PlayedSource* source : {&acs_, &dau_}) {
      source->describe();
      source->report(wire::SOURCE_RUNNING);
    }
    clock_.every(100ms, [this] {
      for (PlayedSource* source : {&acs_, &dau_}) {
        source->answer_commands();
        source->answer_requests();
        source->send_nothing();
      }
    });
  }
  wire::ServiceStatus newest_status_of(const std::string& run) {
    wire::ServiceStatus newest;
    for (const wire::ServiceStatus& status : published_.statuses()) {
      if (status.run().to_string() == run) {
        newest = status;
      }
    }
    return newest;
  }
};

TEST_F(AnalysisServiceTest, ArmsARunWithSourcesThatWereThereBeforeIt) {
  play_sources();
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
}

TEST_F(AnalysisServiceTest, ArmsARunWhoseSourceComesLate) {
  publish("r1", wire::MEASUREMENT_PLANNED);
  clock_.at(5500ms, [this] { play_sources(); });
  serve_for(5400ms);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_WAITING);
  serve_for(500ms);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
}

TEST_F(AnalysisServiceTest, RefusesARunWhoseSourceNeverCame) {
  dau_.describe();
  dau_.report(wire::SOURCE_RUNNING);
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(Arming::limit);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_WAITING);
  serve_for(300ms);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_REFUSED);
  EXPECT_THAT(newest_status_of("r1").message(),
              testing::StartsWith("source 'acs' of bench 'synthetic' is not on the network"));
}

TEST_F(AnalysisServiceTest, LeavesARunAloneThatHasEndedBeforeIt) {
  play_sources();
  publish("r1", wire::MEASUREMENT_RUNNING); // its last word, and nobody repeats it
  serve_for(10s);
  EXPECT_TRUE(published_.statuses().empty());
  publish("r2", wire::MEASUREMENT_PLANNED); // it goes on to serve
  serve_for(1s);
  EXPECT_EQ(newest_status_of("r2").arm(), wire::ARM_ARMED);
  EXPECT_EQ(newest_status_of("r1").run().to_string(), "");
}

TEST_F(AnalysisServiceTest, TakesARunOverThatNobodyLeads) {
  acs_.answer("r1"); // to a service that has died
  dau_.answer("r1");
  play_sources();
  clock_.every(2s, [this] { publish("r1", wire::MEASUREMENT_RUNNING); });
  serve_for(2s + OtherAnalyses::silence_limit - 100ms);
  EXPECT_TRUE(published_.statuses().empty());
  serve_for(5s);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
}

// Without it the run would end with what the samples show, before the conductor has ended it.
TEST_F(AnalysisServiceTest, KnowsTheExcitationThatItHeardOfBeforeItsRun) {
  acs_.answer("r1"); // to a service that has died
  dau_.answer("r1");
  acs_.send(synthetic_.acs_blocks());
  dau_.send(synthetic_.dau_blocks());
  play_sources();
  auto excitations = runner_.writer<wire::Excitation>(bus::topics::excitation, bus::Profile::state,
                                                      tests::played_bench);
  wire::Excitation excitation;
  excitation.bench(tests::played_bench);
  excitation.run("r1");
  excitation.step(1);
  excitation.state(wire::EXCITATION_ABORTED);
  excitations->write(excitation);
  serve_for(100ms);
  clock_.every(2s, [this] { publish("r1", wire::MEASUREMENT_RUNNING); });
  serve_for(30s);
  ASSERT_FALSE(published_.results().empty());
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
}

TEST_F(AnalysisServiceTest, RefusesARunThatItCannotTakeOverFromItsBeginning) {
  play_sources(); // they have never answered for this run
  clock_.every(2s, [this] { publish("r1", wire::MEASUREMENT_RUNNING); });
  serve_for(10s);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_REFUSED);
}

TEST_F(AnalysisServiceTest, EndsARunWhoseRunnerIsLost) {
  play_sources();
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  publish("r1", wire::MEASUREMENT_RUNNING);
  serve_for(RunSession::runner_limit);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
  serve_for(500ms);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_FINISHED);
}

TEST_F(AnalysisServiceTest, KeepsTheNewestRunsOfABenchForLateJoiners) {
  wire::Measurement without_steps = measurement("", wire::MEASUREMENT_PLANNED);
  without_steps.steps().clear(); // refused at once
  for (int run = 1; run <= 5; ++run) {
    without_steps.run("run-" + std::to_string(run));
    measurements_.write(without_steps);
    serve_for(200ms);
  }
  std::set<std::string> runs;
  tests::PublishedByAnalysis late(network_, "late");
  for (const wire::ServiceStatus& status : late.statuses()) {
    EXPECT_EQ(status.arm(), wire::ARM_REFUSED);
    runs.insert(status.run().to_string());
  }
  EXPECT_EQ(runs, (std::set<std::string>{"run-3", "run-4", "run-5"}));
  EXPECT_EQ(runs.size(), AnalysisService::kept_runs);
}

TEST_F(AnalysisServiceTest, SurvivesAMalformedMessage) {
  play_sources();
  network_.inject(bus::topics::measurement, tests::played_bench, "no measurement");
  network_.inject(bus::topics::source_description, tests::played_bench, std::string(3, '\0'));
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
}

TEST_F(AnalysisServiceTest, RefusesASecondRunOfABenchWhileTheFirstIsAlive) {
  play_sources();
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  publish("r1", wire::MEASUREMENT_RUNNING);
  serve_for(1s);
  publish("r2", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  EXPECT_EQ(newest_status_of("r2").arm(), wire::ARM_WAITING);
  EXPECT_EQ(newest_status_of("r2").message(), "waiting for run 'r1' of this bench to end");
  publish("r1", wire::MEASUREMENT_RUNNING); // as every 2 s
  serve_for(1s);
  EXPECT_EQ(newest_status_of("r2").arm(), wire::ARM_REFUSED);
  EXPECT_EQ(newest_status_of("r2").message(),
            "bench 'synthetic' is in use by run 'r1' of lab-pc:17; wait for its end, or end it "
            "there");
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
  EXPECT_EQ(newest_status_of("r1").health(), wire::HEALTH_OK);
}

TEST_F(AnalysisServiceTest, TakesNothingOfAnotherConductorOrRecipeForARunOfTheSameName) {
  play_sources();
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  publish("r1", wire::MEASUREMENT_RUNNING);
  serve_for(1s);
  wire::Measurement other = measurement("r1", wire::MEASUREMENT_ABORTED);
  other.recipe_sha256("other");
  measurements_.write(other);
  serve_for(1s);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
  EXPECT_EQ(newest_status_of("r1").health(), wire::HEALTH_OK);
  publish("r2", wire::MEASUREMENT_PLANNED);
  for (int i = 0; i < 3; ++i) { // it does not keep the dead run alive either
    other = measurement("r1", wire::MEASUREMENT_PLANNED);
    other.conductor("other-pc:3");
    serve_for(2s);
    measurements_.write(other);
  }
  serve_for(1s);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_FINISHED);
  EXPECT_EQ(newest_status_of("r2").arm(), wire::ARM_ARMED);
}

TEST_F(AnalysisServiceTest, GoesOnWithARunThatAnotherConductorResumes) {
  play_sources();
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  publish("r1", wire::MEASUREMENT_RUNNING);
  serve_for(1s);
  wire::Measurement resumed = measurement("r1", wire::MEASUREMENT_RUNNING);
  resumed.conductor("other-pc:3");
  measurements_.write(resumed);
  publish("r2", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  measurements_.write(resumed);
  serve_for(1s);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
  EXPECT_EQ(newest_status_of("r2").arm(), wire::ARM_REFUSED);
  EXPECT_EQ(newest_status_of("r2").message(),
            "bench 'synthetic' is in use by run 'r1' of other-pc:3; wait for its end, or end it "
            "there");
}

TEST_F(AnalysisServiceTest, EndsARunThatHasDiedForTheNextOneOfItsBench) {
  play_sources();
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  publish("r1", wire::MEASUREMENT_RUNNING);
  serve_for(1s);
  publish("r2", wire::MEASUREMENT_PLANNED);
  serve_for(RunSession::bench_limit - 1s); // it was heard a second before
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
  EXPECT_EQ(newest_status_of("r2").arm(), wire::ARM_WAITING);
  serve_for(500ms);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_FINISHED);
  EXPECT_EQ(newest_status_of("r1").health(), wire::HEALTH_FAILED);
  EXPECT_EQ(newest_status_of("r1").message(),
            "nothing was heard of this run for 4 s; its bench was given to run 'r2'");
  EXPECT_EQ(newest_status_of("r2").arm(), wire::ARM_ARMED);
  EXPECT_EQ(newest_status_of("r2").message(), "");
}

// Its last word may be older than that where the link was down: the next one listens for a while.
TEST_F(AnalysisServiceTest, ListensForARunBeforeItGivesItsBenchAway) {
  play_sources();
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  publish("r1", wire::MEASUREMENT_RUNNING);
  serve_for(10s);
  publish("r2", wire::MEASUREMENT_PLANNED);
  serve_for(2s);
  EXPECT_EQ(newest_status_of("r2").arm(), wire::ARM_WAITING);
  publish("r1", wire::MEASUREMENT_RUNNING);
  serve_for(1s);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
  EXPECT_EQ(newest_status_of("r2").arm(), wire::ARM_REFUSED);
}

TEST_F(AnalysisServiceTest, RefusesASecondRunAsSoonAsTheFirstAnnouncesItsExcitation) {
  play_sources();
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  publish("r1", wire::MEASUREMENT_RUNNING);
  serve_for(1s);
  publish("r2", wire::MEASUREMENT_PLANNED);
  serve_for(100ms);
  wire::Excitation excitation; // as every 0.5 s while it drives
  excitation.bench(tests::played_bench);
  excitation.run("r1");
  excitation.step(1);
  excitation.attempt(1);
  excitation.state(wire::EXCITATION_SETTLING);
  runner_.writer(bus::topics::excitation, tests::played_bench)->write(excitation);
  serve_for(100ms);
  EXPECT_EQ(newest_status_of("r2").arm(), wire::ARM_REFUSED);
}

TEST_F(AnalysisServiceTest, LetsARunThatIsOverFinishBeforeTheNextOneOfItsBench) {
  play_sources();
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  publish("r1", wire::MEASUREMENT_RUNNING);
  serve_for(1s);
  publish("r1", wire::MEASUREMENT_DONE);
  publish("r2", wire::MEASUREMENT_PLANNED);
  serve_for(RunSession::bench_limit + 1s);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_FINISHED);
  EXPECT_EQ(newest_status_of("r1").health(), wire::HEALTH_OK);
  EXPECT_EQ(newest_status_of("r2").arm(), wire::ARM_ARMED);
}

// Of what it keeps by name, whatever names there are.
class FloodedAnalysis : public AnalysisServiceTest {
protected:
  bus::Participant stranger_ = network_.join("stranger");
  int floods_ = 0;

  template <class Message>
  void write(const bus::Topic<Message>& topic, const std::string& bench, Message message) {
    message.bench(bench);
    stranger_.writer(topic, bench)->write(message);
  }
  // A run, a source and an analysis of each of many benches.
  void flood(std::size_t names) {
    ++floods_;
    wire::Measurement planned = measurement("foreign", wire::MEASUREMENT_PLANNED);
    wire::SourceDescription description = synthetic_.acs_description();
    wire::ServiceStatus status;
    status.service("analysis@stranger:1");
    for (std::size_t i = 0; i < names; ++i) {
      const std::string bench = "foreign-" + std::to_string(floods_) + "-" + std::to_string(i);
      status.run("led-" + std::to_string(i));
      write(bus::topics::measurement, bench, planned);
      write(bus::topics::service_status, bench, status);
      description.source("foreign-" + std::to_string(i));
      write(bus::topics::source_description, bench, description);
      write(bus::topics::source_description, tests::played_bench, description);
      if (i % 500 == 0) {
        serve_for(1ms);
      }
    }
    serve_for(200ms);
  }
  void expect_limits(std::size_t names) {
    EXPECT_EQ(figures_.benches, KnownBenches::max_benches);
    EXPECT_LE(figures_.sources, KnownBenches::max_benches * KnownBenches::max_sources);
    EXPECT_EQ(figures_.runs_waiting + figures_.runs_armed + figures_.runs_refused +
                  figures_.runs_finished,
              AnalysisService::max_runs);
    EXPECT_LE(figures_.runs_of_others, FollowedRuns::max_runs);
    EXPECT_THAT(left_out("benches"), testing::Gt(names - 2 * KnownBenches::max_benches));
    EXPECT_THAT(left_out("sources"), testing::Gt(names - 2 * KnownBenches::max_benches));
    EXPECT_THAT(left_out("runs"), testing::Gt(names - 2 * AnalysisService::max_runs));
    EXPECT_THAT(left_out("runs_of_others"), testing::Gt(names - 2 * OtherAnalyses::max_runs));
  }
  std::uint64_t left_out(const std::string& what) {
    for (const auto& [name, count] : figures_.left_out) {
      if (name == what) {
        return count;
      }
    }
    return 0;
  }
  void play_to_the_end() {
    publish("r1", wire::MEASUREMENT_RUNNING);
    acs_.send(synthetic_.acs_blocks());
    dau_.send(synthetic_.dau_blocks());
    serve_for(1s);
    publish("r1", wire::MEASUREMENT_DONE);
    serve_for(RunSession::quiet_limit + 1s);
    EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_FINISHED);
    EXPECT_EQ(newest_status_of("r1").health(), wire::HEALTH_OK);
    EXPECT_EQ(published_.results().size(), 1U);
  }
};

// Its sources have described themselves once, and before all others.
TEST_F(FloodedAnalysis, KeepsToItsLimitsAndServesARunAfterwards) {
  play_sources();
  serve_for(100ms);
  flood(10'000);
  expect_limits(10'000);
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  ASSERT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
  play_to_the_end();
}

TEST_F(FloodedAnalysis, DropsNothingOfARunThatLives) {
  play_sources();
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  ASSERT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
  flood(3000);
  expect_limits(3000);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
  play_to_the_end();
}

TEST_F(AnalysisServiceTest, GoesOnWithARunUnderManyMoreOfItsBench) {
  play_sources();
  publish("r1", wire::MEASUREMENT_PLANNED);
  serve_for(1s);
  for (int run = 0; run <= static_cast<int>(AnalysisService::kept_runs); ++run) {
    publish("foreign-" + std::to_string(run), wire::MEASUREMENT_PLANNED);
  }
  for (int seconds = 0; seconds < 10; seconds += 2) {
    publish("r1", wire::MEASUREMENT_RUNNING);
    serve_for(2s);
  }
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
  EXPECT_EQ(newest_status_of("r1").health(), wire::HEALTH_OK);
  EXPECT_EQ(newest_status_of("r1").message(), "");
  EXPECT_EQ(newest_status_of("foreign-0").arm(), wire::ARM_REFUSED);
  EXPECT_EQ(figures_.runs_armed, 1U);
}

// Two services on one network, in turns of 100 ms.
class TwoAnalyses : public AnalysisServiceTest {
protected:
  std::unique_ptr<AnalysisService> other_ =
      AnalysisService::create(network_.join("other analysis"),
                              {.service = "analysis@test:0", .host = "test", .dds = "memory"},
                              clock_)
          .value();

  void serve_with_both(std::chrono::nanoseconds time) {
    for (; time > 0s; time -= 200ms) {
      serve_for(100ms);
      std::swap(service_, other_);
      serve_for(100ms);
      std::swap(service_, other_);
    }
  }
  std::set<std::string> services_of(const std::string& run, std::size_t from) {
    std::set<std::string> services;
    const auto& statuses = published_.statuses();
    for (std::size_t i = from; i < statuses.size(); ++i) {
      if (statuses[i].run().to_string() == run) {
        services.insert(statuses[i].service().to_string());
      }
    }
    return services;
  }
  void run(const std::string& name) {
    publish(name, wire::MEASUREMENT_PLANNED);
    serve_with_both(1s);
    EXPECT_EQ(newest_status_of(name).arm(), wire::ARM_ARMED);
    clock_.every(2s, [this, name] { publish(name, wire::MEASUREMENT_RUNNING); });
    serve_with_both(3s);
  }
};

TEST_F(TwoAnalyses, OneOfThemLeadsARunAndTheOtherStandsBy) {
  play_sources();
  run("r1");
  const std::size_t settled = published_.statuses().size();
  serve_with_both(10s);
  EXPECT_EQ(services_of("r1", settled).size(), 1U);
}

TEST_F(TwoAnalyses, TheOtherTakesARunOverWhoseLeaderHasDied) {
  play_sources();
  run("r1");
  const std::string leader = newest_status_of("r1").service().to_string();
  if (leader == "analysis@test:1") {
    std::swap(service_, other_);
  }
  other_.reset(); // the leader
  const std::size_t before = published_.statuses().size();
  serve_for(OtherAnalyses::silence_limit - 1s);
  EXPECT_EQ(published_.statuses().size(), before);
  serve_for(2s);
  EXPECT_EQ(services_of("r1", before).size(), 1U);
  EXPECT_NE(newest_status_of("r1").service().to_string(), leader);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
}

TEST_F(TwoAnalyses, ALeaderThatWasStoppedAgreesWithWhoTookItsRunOver) {
  play_sources();
  run("r1");
  const std::string leader = newest_status_of("r1").service().to_string();
  if (leader == "analysis@test:1") {
    std::swap(service_, other_);
  }
  serve_for(30s); // the leader is stopped
  EXPECT_NE(newest_status_of("r1").service().to_string(), leader);
  serve_with_both(2s);
  const std::size_t settled = published_.statuses().size();
  serve_with_both(10s);
  EXPECT_EQ(services_of("r1", settled).size(), 1U);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
}

TEST_F(TwoAnalyses, TheLeaderOfABenchRefusesASecondRun) {
  play_sources();
  run("r1");
  publish("r2", wire::MEASUREMENT_PLANNED);
  serve_with_both(3s);
  EXPECT_EQ(newest_status_of("r2").arm(), wire::ARM_REFUSED);
  EXPECT_EQ(services_of("r2", 0), services_of("r1", 0));
}

TEST_F(AnalysisServiceTest, DoesNotTakeARunOverFromOtherSoftware) {
  play_sources();
  bus::Participant stranger = network_.join("stranger");
  auto statuses = stranger.writer(bus::topics::service_status, tests::played_bench).value();
  wire::ServiceStatus status;
  status.bench(tests::played_bench);
  status.run("r1");
  status.service("analysis@other:5");
  status.arm(wire::ARM_ARMED);
  status.software("dyncal 0.0.1");
  statuses.write(status);
  clock_.every(2s, [this] { publish("r1", wire::MEASUREMENT_RUNNING); });
  serve_for(20s);
  EXPECT_EQ(newest_status_of("r1").service().to_string(), "analysis@other:5");
}

// The host was updated in the run: the service that begins now has heard of no other.
TEST_F(AnalysisServiceTest, DoesNotTakeARunOverThatBeganWithOtherSoftware) {
  acs_.answer("r1"); // to a service that has died
  dau_.answer("r1");
  play_sources();
  clock_.every(2s, [this] {
    wire::Measurement running = measurement("r1", wire::MEASUREMENT_RUNNING);
    running.analysis_software("dyncal 0.0.1");
    measurements_.write(running);
  });
  serve_for(20s);
  EXPECT_TRUE(published_.statuses().empty());
}

TEST_F(AnalysisServiceTest, TakesARunOverThatBeganWithItsOwnSoftware) {
  acs_.answer("r1"); // to a service that has died
  dau_.answer("r1");
  play_sources();
  clock_.every(2s, [this] {
    wire::Measurement running = measurement("r1", wire::MEASUREMENT_RUNNING);
    running.analysis_software(software_version());
    measurements_.write(running);
  });
  serve_for(20s);
  EXPECT_EQ(newest_status_of("r1").arm(), wire::ARM_ARMED);
}

} // namespace
} // namespace dyncal::inline programs
