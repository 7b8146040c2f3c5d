// The conductor of a run against an analysis service that the test plays, on a real bus.
#include <atomic>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "services/contract/topics.hpp"
#include "services/run/run_controller.hpp"

namespace dyncal::services {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr int test_domain = 57;
constexpr auto patience = 20s;

bus::Participant join() {
  bus::ParticipantOptions options;
  options.vendor = bus::vendors_in_this_build().front();
  options.domain = test_domain;
  options.name = "run controller test";
  return bus::Participant::create(options).value();
}

BenchFile bench_without_generator() {
  BenchFile bench;
  bench.bench = "run-controller-test-" + std::to_string(getpid());
  bench.excitation.frequencies_hz = {"10"};
  bench.excitation.levels_m_s2 = {1.0};
  bench.generator.driver = "none";
  bench.method.reference = {"acs", "reference"};
  bench.method.sync_acs = {"acs", "sync"};
  bench.method.sync_dau = {"dau", "sync"};
  return bench;
}

constexpr const char* run_name = "run-1";

// Says what an analysis service says of one run, each message when the test wants it.
class PlayedAnalysis {
public:
  explicit PlayedAnalysis(const std::string& bench) : bench_(bench) {}

  // False when the run does not come to that state in time.
  bool wait_for(wire::MeasurementState state) {
    const auto deadline = Clock::now() + patience;
    bool reached = false;
    while (!reached && Clock::now() < deadline) {
      measurement_.take([&](const wire::Measurement& message, const bus::SampleInfo& info) {
        reached = reached || (info.valid && message.run() == run_name && message.state() == state);
      });
      if (!reached) {
        bell_->wait_until(deadline);
      }
    }
    return reached;
  }

  void say(wire::ArmState arm, std::uint64_t transfer_functions) {
    wire::ServiceStatus status;
    status.service("played");
    status.run(run_name);
    status.bench(bench_);
    status.health(wire::HEALTH_OK);
    status.arm(arm);
    status.transfer_functions_published(transfer_functions);
    status_.write(status);
    status_.wait_for_acknowledgments(patience);
  }

  void publish_transfer_function(const std::string& channel) {
    wire::TransferFunction function;
    function.bench(bench_);
    function.run(run_name);
    function.channel(channel);
    transfer_functions_.write(function);
    transfer_functions_.wait_for_acknowledgments(patience);
  }

private:
  std::string bench_;
  bus::Participant participant_ = join();
  std::shared_ptr<bus::WakeUp> bell_ = std::make_shared<bus::WakeUp>();
  bus::Reader<wire::Measurement> measurement_ =
      participant_
          .reader<wire::Measurement>(bus::topics::measurement, bus::Profile::state, bench_, bell_)
          .value();
  bus::Writer<wire::ServiceStatus> status_ =
      participant_
          .writer<wire::ServiceStatus>(bus::topics::service_status, bus::Profile::state, bench_)
          .value();
  bus::Writer<wire::TransferFunction> transfer_functions_ =
      participant_
          .writer<wire::TransferFunction>(bus::topics::transfer_function, bus::Profile::results,
                                          bench_)
          .value();
};

TEST(RunController, WaitsForAllTransferFunctionsWhenTheLastComesAfterTheEndWasAnnounced) {
  const BenchFile bench = bench_without_generator();
  PlayedAnalysis analysis(bench.bench);
  std::atomic<int> looks{0}; // of the conductor at its messages
  std::atomic<bool> over{false};
  std::jthread play([&] {
    ASSERT_TRUE(analysis.wait_for(wire::MEASUREMENT_PLANNED));
    analysis.say(wire::ARM_ARMED, 0);
    ASSERT_TRUE(analysis.wait_for(wire::MEASUREMENT_RUNNING));
    analysis.publish_transfer_function("dau/acceleration_x");
    analysis.say(wire::ARM_FINISHED, 2);
    const int before = looks;
    const auto deadline = Clock::now() + patience;
    while (looks < before + 2 && !over && Clock::now() < deadline) {
      std::this_thread::yield();
    }
    analysis.publish_transfer_function("dau/acceleration_y");
  });
  auto participant = join();
  RunController controller(participant, bench, run_name, [&](const RunProgress&) { ++looks; });
  const auto outcome = controller.conduct({}, {});
  over = true;
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_EQ(outcome->problem, "");
  ASSERT_EQ(outcome->transfer_functions.size(), 2U);
  EXPECT_EQ(outcome->transfer_functions[1].channel().to_string(), "dau/acceleration_y");
}

} // namespace
} // namespace dyncal::services
