// One run at the analysis service with its two sources, in stepped time.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "services/programs/analysis/run_session.hpp"
#include "tests/unit/services/programs/analysis/played_sources.hpp"

namespace dyncal::inline programs {

class RunSessionTest : public testing::Test {
protected:
  tests::SyntheticRun synthetic_{.steps = {{"40", 10.0}}};
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  bus::Participant participant_ = network_.join("analysis");
  std::shared_ptr<bus::WakeUp> wake_up_ = std::make_shared<bus::WakeUp>();
  KnownSources sources_;
  tests::PlayedSource acs_{network_, synthetic_.acs_description()};
  tests::PlayedSource dau_{network_, synthetic_.dau_description()};
  tests::PublishedByAnalysis published_{network_};
  std::unique_ptr<RunSession> session_ = create(synthetic_.measurement());

  std::unique_ptr<RunSession>
  create(const wire::Measurement& measurement, const std::string& service = "analysis@test:1",
         SourceStreams::Begin begin = SourceStreams::Begin::with_answer) {
    const AnalysisContext context{
        participant_, clock_, wake_up_, {.service = service, .host = "test", .dds = "memory"}};
    auto requests = SourceRequests::open(participant_, tests::played_bench, service);
    return RunSession::create(context, measurement, requests.value(), begin).value();
  }

  void describe(const tests::PlayedSource& source) {
    sources_[source.name()].description = source.description();
  }
  void report(const tests::PlayedSource& source, wire::SourceState state,
              const std::string& message) {
    wire::SourceStatus status;
    status.state(state);
    status.message(message);
    sources_[source.name()].status = status;
  }
  void set_state(wire::MeasurementState state) {
    wire::Measurement measurement = synthetic_.measurement();
    measurement.state(state);
    session_->update(measurement);
  }
  void announce(wire::ExcitationState state) {
    wire::Excitation excitation;
    excitation.bench(tests::played_bench);
    excitation.run(tests::played_run);
    excitation.step(1);
    excitation.state(state);
    session_->announce(excitation);
  }
  void work() { session_->work(sources_); }
  // As a service that runs: it works at least every 500 ms.
  void pass(std::chrono::nanoseconds time) {
    using namespace std::chrono_literals;
    for (; time > 500ms; time -= 500ms) {
      clock_.advance(500ms);
      work();
    }
    clock_.advance(time);
    work();
  }
  wire::ArmState arm_state() { return published_.newest_status().arm(); }

  // Arms at once.
  void arm() {
    for (tests::PlayedSource* source : {&acs_, &dau_}) {
      describe(*source);
    }
    work();
    acs_.answer(tests::played_run);
    dau_.answer(tests::played_run);
    work();
    ASSERT_EQ(arm_state(), wire::ARM_ARMED);
  }
  void arm_and_run() {
    arm();
    set_state(wire::MEASUREMENT_RUNNING);
  }
  // Works every 100 ms, with the run kept alive and these sources sending.
  void run_for(std::chrono::milliseconds time, const std::vector<tests::PlayedSource*>& sending) {
    using namespace std::chrono_literals;
    for (; time > 0ms; time -= 100ms) {
      clock_.advance(100ms);
      set_state(wire::MEASUREMENT_RUNNING);
      for (tests::PlayedSource* source : sending) {
        source->send_nothing();
      }
      work();
    }
  }
};

} // namespace dyncal::inline programs
