// The service between the bus and instruments that answer over TCP: the virtual bench's
// oscilloscope and time series sensor, switched off and on, and over bad lines.
#include "services/programs/dso/triggered_bench.hpp"

#include <chrono>
#include <map>
#include <set>
#include <thread>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/link/stop_signal.hpp"
#include "drivers/tss/series_source.hpp"
#include "drivers/virtual_bench/wire/triggered_server.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/contract/topics.hpp"
#include "services/stream/source_service.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"

namespace dyncal::inline programs::dso {
namespace {

using namespace std::chrono_literals;
namespace device = drivers::virtual_bench;
using testing::HasSubstr;

// Both instruments, served from a thread of their own; bench time runs ten times as fast as the
// host's clock at most.
class Instruments {
public:
  explicit Instruments(device::ScopeFaults faults, std::uint16_t scope_port = 0,
                       std::uint16_t sensor_port = 0) {
    device::TriggeredSettings settings;
    settings.scope_listen = {"127.0.0.1", scope_port};
    settings.sensor_listen = {"127.0.0.1", sensor_port};
    settings.faults = std::move(faults);
    settings.sensor = device::series_sensor_of(*device::preset_by_name("tss"), 1, 157.0);
    settings.sensor.samples = 200;
    server_.emplace(settings);
    EXPECT_TRUE(server_->open().has_value());
    excitation_.change(0.0, {100.0, 0.2, true, false});
    thread_ = std::jthread([this](const std::stop_token& stop) {
      for (double time_s = 1.0; !stop.stop_requested(); time_s += 0.01) {
        server_->serve();
        server_->advance_to(time_s, excitation_);
        static_cast<void>(pause_.wait_for(1ms));
      }
    });
  }
  [[nodiscard]] std::uint16_t scope_port() const { return server_->scope_port(); }
  [[nodiscard]] std::uint16_t sensor_port() const { return server_->sensor_port(); }

private:
  device::Excitation excitation_{device::ExciterModel{}};
  std::optional<device::TriggeredServer> server_;
  drivers::StopSignal pause_; // not raised
  std::jthread thread_;
};

class TriggeredBenchTest : public testing::Test {
protected:
  void start(device::ScopeFaults faults = {}, int shots = 4) {
    instruments_.emplace(std::move(faults));
    scope_port_ = instruments_->scope_port();
    sensor_port_ = instruments_->sensor_port();
    const auto bench = parse_bench_file(fmt::format(R"(bench = "{}"
[excitation]
frequencies_hz = ["100"]
level = 10.0
[sources.dso]
driver = "oscilloscope"
address = "127.0.0.1:{}"
[sources.tss]
driver = "series"
address = "127.0.0.1:{}"
[sources.acs]
driver = "socket"
address = "127.0.0.1:1"
[method]
kind = "series-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dso = "dso/sync"
dut = ["tss/acceleration_z"]
shots = {}
)",
                                                    bench_, scope_port_, sensor_port_, shots),
                                        "bench.toml");
    ASSERT_TRUE(bench.has_value()) << bench.error().message;
    auto triggered = TriggeredBench::create(participant_, *service_, *bench, ring_);
    ASSERT_TRUE(triggered.has_value()) << triggered.error().message;
    bench_under_test_ = std::move(*triggered);
    if (publishing_) {
      service_->start();
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { bench_under_test_->run(stop); });
  }

  void announce(std::uint32_t step, wire::ExcitationState state) {
    wire::Excitation excitation;
    excitation.bench(bench_);
    excitation.run("run-1");
    excitation.step(step);
    excitation.frequency_text_hz("100");
    excitation.state(state);
    excitation_.write(excitation);
  }

  void take() {
    traces_.take([&](const wire::TriggeredRecord& record) {
      take_marks(record);
      if (record.sample_count() > 0) {
        EXPECT_EQ(record.values().size(), 10'000U);
        trace_shots_[record.step()].insert(record.shot());
      }
    });
    series_.take([&](const wire::TriggeredRecord& record) {
      take_marks(record);
      if (record.sample_count() > 0) {
        EXPECT_EQ(record.run(), "run-1");
        EXPECT_EQ(record.sample_count(), 200U);
        EXPECT_EQ(record.values().size(), 200U);
        series_shots_[record.step()].insert(record.shot());
      }
    });
    status_.take([&](const wire::SourceStatus& status) {
      if (status.source() == "dso") {
        status_seen_ = status;
        if (!status.message().empty()) {
          messages_.insert(status.message());
        }
      }
    });
  }

  void take_marks(const wire::TriggeredRecord& record) {
    if (record.acknowledged_run() == "run-1") {
      answered_.insert(record.source().to_string());
    }
    if (record.end_of_stream()) {
      ended_.insert(record.source().to_string());
    }
  }

  template <class Condition>
  [[nodiscard]] bool wait_for(Condition&& condition) {
    const auto deadline = std::chrono::steady_clock::now() + tests::patience;
    for (take(); !condition(); take()) {
      if (std::chrono::steady_clock::now() > deadline) {
        return false;
      }
      bell_->wait_until(std::min(deadline, std::chrono::steady_clock::now() + 20ms));
    }
    return true;
  }
  [[nodiscard]] bool has_shots(std::uint32_t step, std::size_t count) {
    return trace_shots_[step].size() == count && series_shots_[step] == trace_shots_[step];
  }
  [[nodiscard]] bool is(wire::SourceState state) const {
    return status_seen_ && status_seen_->state() == state;
  }

  static bus::Participant join() {
    bus::ParticipantOptions options;
    options.vendor = bus::vendors_in_this_build().front();
    options.domain = tests::own_dds_domain();
    options.name = "dyncal-dso test";
    return bus::Participant::create(options).value();
  }

  const std::string bench_ = "dso-service";
  std::optional<Instruments> instruments_;
  std::uint16_t scope_port_ = 0;
  std::uint16_t sensor_port_ = 0;
  bus::Participant participant_ = join();
  std::shared_ptr<bus::WakeUp> bell_ = std::make_shared<bus::WakeUp>();
  bus::Writer<wire::Excitation> excitation_ =
      participant_.writer<wire::Excitation>(bus::topics::excitation, bus::Profile::state, bench_)
          .value();
  bus::Reader<wire::TriggeredRecord> traces_ =
      participant_
          .reader<wire::TriggeredRecord>(bus::topics::dso_record, bus::Profile::samples, bench_,
                                         bell_)
          .value();
  bus::Reader<wire::TriggeredRecord> series_ =
      participant_
          .reader<wire::TriggeredRecord>(bus::topics::tss_record, bus::Profile::samples, bench_,
                                         bell_)
          .value();
  bus::Reader<wire::SourceStatus> status_ =
      participant_
          .reader<wire::SourceStatus>(bus::topics::source_status, bus::Profile::state, bench_,
                                      bell_)
          .value();
  std::unique_ptr<SourceService> service_ =
      SourceService::create(participant_, {.software = "test"});
  RingLimits ring_ = {};
  bool publishing_ = true; // false: as if no write ever got through
  std::unique_ptr<TriggeredBench> bench_under_test_;
  std::map<std::uint32_t, std::set<std::uint64_t>> trace_shots_;
  std::map<std::uint32_t, std::set<std::uint64_t>> series_shots_;
  std::set<std::string> answered_;
  std::set<std::string> ended_;
  std::optional<wire::SourceStatus> status_seen_;
  std::set<std::string> messages_;
  std::jthread thread_; // ends before what it uses
};

TEST_F(TriggeredBenchTest, AStepThatIsSteadyGetsItsShotsAndNoMore) {
  start();
  announce(1, wire::EXCITATION_STEADY);
  ASSERT_TRUE(wait_for([&] { return has_shots(1, 4); }));
  announce(1, wire::EXCITATION_DONE);
  announce(2, wire::EXCITATION_STEADY);
  ASSERT_TRUE(wait_for([&] { return has_shots(2, 4); }));
  EXPECT_TRUE(has_shots(1, 4));
  EXPECT_EQ(*trace_shots_[1].begin(), 1U);
  EXPECT_EQ(*trace_shots_[2].rbegin(), 8U);
}

TEST_F(TriggeredBenchTest, TheFirstShotAfterAStartIsLeftOutAndIsNoFault) {
  start();
  ASSERT_TRUE(wait_for([&] { return is(wire::SOURCE_RUNNING); }));
  const drivers::StopSignal never;
  const auto sensor =
      drivers::tss::series_from_socket(fmt::format("127.0.0.1:{}", sensor_port_), never);
  ASSERT_TRUE(sensor->discard_pending().has_value());
  announce(1, wire::EXCITATION_STEADY);
  ASSERT_TRUE(wait_for([&] { return has_shots(1, 4); }));
  for (const std::uint64_t trigger : {1U, 2U, 3U, 4U, 5U}) { // one more than shots
    const auto series = sensor->next(tests::patience);
    ASSERT_TRUE(series.has_value()) << series.error().message;
    EXPECT_EQ(series->shot, trigger);
  }
  ASSERT_TRUE(wait_for([&] { return status_seen_->received() == 4; }));
  EXPECT_EQ(status_seen_->rejected(), 0U);
  EXPECT_THAT(messages_, testing::IsEmpty());
}

TEST_F(TriggeredBenchTest, AnInstrumentThatIsSwitchedOffAndOnAgainGoesOnWithTheStep) {
  start({}, 1000);
  announce(1, wire::EXCITATION_STEADY);
  ASSERT_TRUE(wait_for([&] { return trace_shots_[1].size() >= 2; }));
  instruments_.reset();
  ASSERT_TRUE(wait_for([&] { return is(wire::SOURCE_SILENT); }));
  EXPECT_THAT(status_seen_->message(), HasSubstr("127.0.0.1:" + std::to_string(scope_port_)));
  EXPECT_GT(status_seen_->rejected(), 0U);
  const std::size_t before = series_shots_[1].size();
  instruments_.emplace(device::ScopeFaults{}, scope_port_, sensor_port_);
  ASSERT_TRUE(wait_for([&] { return series_shots_[1].size() > before + 2; }));
  EXPECT_TRUE(wait_for([&] { return is(wire::SOURCE_RUNNING); }));
}

TEST_F(TriggeredBenchTest, AStepThatEndedWithoutItsShotsIsNotGoneOnWith) {
  start({}, 1000);
  announce(1, wire::EXCITATION_STEADY);
  ASSERT_TRUE(wait_for([&] { return trace_shots_[1].size() >= 2; }));
  announce(2, wire::EXCITATION_SETTLING); // the end of step 1 was never seen
  announce(2, wire::EXCITATION_STEADY);
  ASSERT_TRUE(wait_for([&] { return trace_shots_[2].size() >= 3; }));
  const std::uint64_t last_of_1 = *trace_shots_[1].rbegin();
  EXPECT_LT(last_of_1, *trace_shots_[2].begin());
}

// The devices are served on while not one record gets to the network, as with a reader that has
// stopped; what was taken is published once it can be.
TEST_F(TriggeredBenchTest, AWriterThatIsBlockedDoesNotHoldUpTheDevices) {
  publishing_ = false;
  start({}, 6);
  announce(1, wire::EXCITATION_STEADY);
  const auto shots_taken = [&] { return bench_under_test_->shots_taken(); };
  ASSERT_TRUE(wait_for([&] { return shots_taken() == 6; }));
  announce(1, wire::EXCITATION_DONE);
  announce(2, wire::EXCITATION_STEADY);
  ASSERT_TRUE(wait_for([&] { return shots_taken() == 12; }));
  EXPECT_TRUE(trace_shots_.empty() && series_shots_.empty()) << "nothing was published yet";
  service_->start();
  EXPECT_TRUE(wait_for([&] { return has_shots(1, 6) && has_shots(2, 6); }));
  EXPECT_TRUE(wait_for([&] { return status_seen_ && status_seen_->received() == 12; }));
  EXPECT_EQ(status_seen_->dropped_in_service(), 0U);
}

TEST_F(TriggeredBenchTest, APairWithoutRoomIsCountedAndRepeated) {
  publishing_ = false;
  ring_.bytes = 100'000; // one trace of 10 000 points
  start({}, 3);
  announce(1, wire::EXCITATION_STEADY);
  ASSERT_TRUE(wait_for([&] { return bench_under_test_->shots_taken() >= 2; }));
  service_->start();
  ASSERT_TRUE(wait_for([&] { return is(wire::SOURCE_RUNNING) && trace_shots_[1].size() >= 3; }));
  EXPECT_TRUE(wait_for([&] { return status_seen_->dropped_in_service() > 0; }));
  EXPECT_THAT(messages_, testing::Contains(HasSubstr("the network does not take the records")));
}

TEST_F(TriggeredBenchTest, BothSourcesAnswerARunAndEndTheirStreams) {
  start();
  bus::Writer<wire::Command> commands =
      participant_.writer<wire::Command>(bus::topics::command, bus::Profile::command, bench_)
          .value();
  ASSERT_TRUE(wait_for([&] { return is(wire::SOURCE_RUNNING); }));
  auto asked = std::chrono::steady_clock::time_point{};
  ASSERT_TRUE(wait_for([&] {
    if (std::chrono::steady_clock::now() - asked > 250ms) {
      asked = std::chrono::steady_clock::now();
      for (const char* source : {"dso", "tss"}) {
        wire::Command command;
        command.target(source);
        command.kind(wire::COMMAND_ARM);
        command.bench(bench_);
        command.run("run-1");
        commands.write(command);
      }
    }
    return answered_.size() == 2;
  }));
  thread_ = {};
  service_->stop();
  EXPECT_TRUE(wait_for([&] { return ended_.size() == 2 && is(wire::SOURCE_ENDED); }));
}

class BadLine : public TriggeredBenchTest, public testing::WithParamInterface<const char*> {};

TEST_P(BadLine, IsNamedAndItsShotsAreRepeated) {
  start({{GetParam(), std::string(GetParam()) == "wrong-length" ? 0.3 : 0.02}}, 10);
  announce(1, wire::EXCITATION_STEADY);
  ASSERT_TRUE(wait_for([&] { return has_shots(1, 10); }));
  if (status_seen_ && status_seen_->rejected() > 0) {
    EXPECT_FALSE(messages_.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Faults, BadLine,
                         testing::Values("half-answer", "garbage", "wrong-length", "other-answer",
                                         "disconnect"),
                         [](const auto& fault) {
                           std::string name = fault.param;
                           std::erase(name, '-');
                           return name;
                         });

} // namespace
} // namespace dyncal::inline programs::dso
