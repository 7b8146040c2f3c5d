// Oscilloscope and time series sensor of the virtual bench, through the drivers that real ones are
// reached with.
#include "drivers/virtual_bench/wire/triggered_server.hpp"

#include <atomic>
#include <cmath>
#include <memory>
#include <numbers>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/dso/oscilloscope.hpp"
#include "drivers/tss/series_source.hpp"
#include "tests/patience.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr double frequency_hz = 100.0;

// Serves both instruments from a thread of its own; bench time runs ten times as fast as the host's
// clock at most.
class TriggeredServerTest : public testing::Test {
protected:
  void start(ScopeFaults faults = {}, std::size_t piece_bytes = 0, bool on = true) {
    TriggeredSettings settings;
    settings.scope_listen = settings.sensor_listen = {"127.0.0.1", 0};
    settings.faults = std::move(faults);
    settings.piece_bytes = piece_bytes;
    settings.sensor = series_sensor_of(*preset_by_name("tss"), 1, 157.0);
    settings.sensor.samples = 200;
    server_ = std::make_unique<TriggeredServer>(settings);
    ASSERT_TRUE(server_->open().has_value());
    excitation_.change(0.0, {frequency_hz, 0.2, on, false});
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    dso::OscilloscopeSettings scope;
    scope.address = "127.0.0.1:" + std::to_string(server_->scope_port());
    scope.inputs = {{"sync", 1, 20.0, 0.0}, {"trigger", 2, 4.0, 1.5}};
    scope.answer_limit = answer_limit_;
    scope_ = std::make_unique<dso::Oscilloscope>(scope, stop_);
    sensor_ = tss::series_from_socket("127.0.0.1:" + std::to_string(server_->sensor_port()), stop_);
  }
  void run(const std::stop_token& stop) {
    for (double time_s = 1.0; !stop.stop_requested(); time_s += 0.01) {
      server_->serve();
      server_->advance_to(time_s, excitation_);
      static_cast<void>(stop_.wait_for(milliseconds(1)));
    }
  }
  Expected<dso::Shot> shoot() {
    DYNCAL_TRY(
        scope_->prepare({.before_trigger_s = 0.01, .after_trigger_s = 0.01, .points = 10'000}));
    return scope_->acquire(trigger_limit_);
  }

  milliseconds answer_limit_ = tests::patience;
  milliseconds trigger_limit_ = tests::patience;
  Excitation excitation_{ExciterModel{}};
  std::unique_ptr<TriggeredServer> server_;
  StopSignal stop_; // not raised: pauses only
  std::jthread thread_;
  std::unique_ptr<dso::Oscilloscope> scope_;
  std::unique_ptr<tss::SeriesSource> sensor_;
};

TEST_F(TriggeredServerTest, AShotHasSyncRisingThroughZeroAtTheTrigger) {
  start();
  const auto shot = shoot();
  ASSERT_TRUE(shot.has_value()) << shot.error().message;
  ASSERT_EQ(shot->traces.size(), 2U);
  EXPECT_DOUBLE_EQ(shot->first_sample_s, -0.01);
  EXPECT_DOUBLE_EQ(shot->interval_s, 2e-6);
  double sine = 0.0;
  double cosine = 0.0;
  const auto& volts = shot->traces[0].volts; // two whole periods
  for (std::size_t i = 0; i < volts.size(); ++i) {
    const double angle = 2.0 * std::numbers::pi * frequency_hz *
                         (shot->first_sample_s + static_cast<double>(i) * shot->interval_s);
    sine += volts[i] * std::sin(angle);
    cosine += volts[i] * std::cos(angle);
  }
  EXPECT_NEAR(2.0 * std::hypot(sine, cosine) / static_cast<double>(volts.size()), 9.75, 0.02);
  EXPECT_NEAR(std::atan2(cosine, sine), -0.02, 0.02); // the trigger came early
  EXPECT_DOUBLE_EQ(shot->traces[0].resolution_v, 0.2);
}

TEST_F(TriggeredServerTest, EveryShotStartsOneSeries) {
  start();
  for (std::uint64_t number = 1; number <= 3; ++number) {
    ASSERT_TRUE(sensor_->discard_pending().has_value());
    ASSERT_TRUE(shoot().has_value());
    const auto series = sensor_->next(tests::patience);
    ASSERT_TRUE(series.has_value()) << series.error().message;
    EXPECT_EQ(series->shot, number);
    EXPECT_EQ(series->samples, 200U);
    EXPECT_EQ(series->channels[0].name, "acceleration_z");
  }
}

TEST_F(TriggeredServerTest, AnswersInPiecesAreWhole) {
  start({}, 700);
  const auto shot = shoot();
  ASSERT_TRUE(shot.has_value()) << shot.error().message;
  EXPECT_EQ(shot->traces[1].volts.size(), 10'000U);
}

TEST_F(TriggeredServerTest, WithoutSyncNothingTriggers) {
  start({}, 0, false);
  trigger_limit_ = milliseconds(200);
  const auto shot = shoot();
  ASSERT_FALSE(shot.has_value());
  EXPECT_THAT(shot.error().message, HasSubstr("no trigger within"));
}

TEST_F(TriggeredServerTest, AnUnknownCommandIsAnErrorInTheInstrumentsWords) {
  start();
  auto connection =
      ScpiConnection::connect("oscilloscope", scope_->address(), tests::patience, stop_);
  ASSERT_TRUE(connection.has_value());
  const auto refused = connection->command(":DISPlay:BEAM ON");
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message, HasSubstr("-113,\"Undefined header\""));
  EXPECT_TRUE(connection->command(":channel1:scale 2").has_value()); // long form, lower case
  EXPECT_FALSE(connection->command(":CHAN1:SCAL 200").has_value());
}

// Whatever a bad line makes of the answers: an error every now and then, never a hang, never a
// wrong shot.
class FaultyScopeTest : public TriggeredServerTest,
                        public testing::WithParamInterface<const char*> {};

TEST_P(FaultyScopeTest, TheDriverSaysSoAndGoesOn) {
  answer_limit_ = milliseconds(500); // half of a slow answer's delay
  trigger_limit_ = milliseconds(2000);
  start({{GetParam(), 0.02}});
  int shots = 0;
  int failures = 0;
  for (int attempt = 0; attempt < 12; ++attempt) {
    const auto shot = shoot();
    if (!shot) {
      ++failures;
      EXPECT_THAT(shot.error().message, HasSubstr(scope_->address()));
    } else {
      ++shots;
      EXPECT_EQ(shot->traces.at(0).volts.size(), 10'000U);
      EXPECT_DOUBLE_EQ(shot->interval_s, 2e-6);
    }
  }
  EXPECT_GT(failures, 0);
  EXPECT_GT(shots, 0);
}

INSTANTIATE_TEST_SUITE_P(Faults, FaultyScopeTest,
                         testing::Values("half-answer", "garbage", "other-answer", "disconnect",
                                         "slow"),
                         [](const auto& fault) {
                           std::string name = fault.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST_F(TriggeredServerTest, ABlockThatSaysAnotherLengthIsNoticed) {
  start({{"wrong-length", 1.0}});
  const auto shot = shoot();
  ASSERT_FALSE(shot.has_value());
  EXPECT_EQ(shot.error().code, ErrorCode::malformed);
}

} // namespace
} // namespace dyncal::drivers::virtual_bench
