#include "drivers/can/sensor_stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>

#include "drivers/can/bus/candump_log.hpp"
#include "drivers/can/bus/scripted_source.hpp"
#include "drivers/can/time/frame_duration.hpp"
#include "tests/unit/drivers/collecting_sink.hpp"

namespace dyncal::drivers::can {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t epoch_ns = 1'700'000'000'000'000'000;

const std::string sensor_dbc = "BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (0.01,0) [0|0] \"m/s^2\" S\n "
                               "SG_ counter : 16|8@1+ (1,0) [0|0] \"\" S\n"
                               "BO_ 292 Second: 8 S\n SG_ y : 0|16@1- (0.01,0) [0|0] \"m/s^2\" S\n "
                               "SG_ counter : 16|8@1+ (1,0) [0|0] \"\" S\n";

using Collected = tests::CollectingSink;

CanFrame sample_frame(std::uint32_t id, int value, int counter) {
  CanFrame frame;
  frame.id = id;
  frame.length = 8;
  frame.data[0] = static_cast<std::uint8_t>(value);
  frame.data[1] = static_cast<std::uint8_t>(value >> 8);
  frame.data[2] = static_cast<std::uint8_t>(counter);
  return frame;
}

StreamSettings one_message() {
  StreamSettings settings;
  settings.messages = {"Sample"};
  settings.counter = "counter";
  settings.nominal_rate_hz = 1000;
  settings.bit_rates.nominal_per_s = 1e6;
  settings.u_utc_s = 1e-6;
  return settings;
}

std::unique_ptr<SensorStream> stream_of(StreamSettings settings,
                                        const std::string& dbc = sensor_dbc) {
  auto stream = SensorStream::create(std::move(settings), *parse_dbc(dbc, "sensor.dbc"));
  EXPECT_TRUE(stream) << stream.error().message;
  return std::move(*stream);
}

LinkState link() {
  LinkState state;
  state.name = "can0";
  state.present = state.up = true;
  return state;
}

// Frame number k of a 1 kHz sensor, received without delay: the kernel's stamp is the end of the
// frame.
CanFrame on_time(int k, int value = 0) {
  CanFrame frame = sample_frame(291, value, k);
  frame.kernel_ns =
      epoch_ns + k * 1'000'000LL + std::llround(frame_duration_s(frame, {1e6, 0.0}) * 1e9);
  return frame;
}

TEST(SensorStream, StampsTheStartOfFrameOfEverySample) {
  const auto stream = stream_of(one_message());
  Collected collected;
  ASSERT_TRUE(stream->begin(link(), collected));
  for (int k = 0; k < 3000; ++k) {
    ASSERT_TRUE(stream->take(on_time(k, k % 7), collected));
  }
  stream->finish(collected);
  const auto stamps = collected.stamps_ns;
  ASSERT_EQ(stamps.size(), 3000U);
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    EXPECT_NEAR(static_cast<double>(stamps[k] - epoch_ns), static_cast<double>(k) * 1e6, 2.0);
  }
  EXPECT_EQ(collected.descriptions.front().stamp_instant, StampInstant::frame_start);
  EXPECT_THAT(collected.descriptions.front().driver, HasSubstr("time by counter"));
  EXPECT_DOUBLE_EQ(collected.descriptions.front().channels.at(0).resolution, 0.01);
  EXPECT_EQ(collected.blocks.front().values.at(3), 0.03);
}

TEST(SensorStream, IsLateByTheFrameDurationWithoutItsCorrection) {
  // Such frames last 112 ... 121 us at 1 Mbit/s.
  StreamSettings settings = one_message();
  settings.correct_frame_duration = false;
  const auto stream = stream_of(settings);
  Collected collected;
  ASSERT_TRUE(stream->begin(link(), collected));
  for (int k = 0; k < 3000; ++k) {
    ASSERT_TRUE(stream->take(on_time(k, k % 7), collected));
  }
  stream->finish(collected);
  const double late_s =
      static_cast<double>(collected.stamps_ns.back() - epoch_ns - 2'999'000'000) * 1e-9;
  EXPECT_GT(late_s, 108e-6);
  EXPECT_LT(late_s, 125e-6);
}

TEST(SensorStream, NumbersEveryLostSampleByTheCounterAcrossItsRange) {
  const auto stream = stream_of(one_message());
  Collected collected;
  ASSERT_TRUE(stream->begin(link(), collected));
  std::uint64_t kept = 0;
  for (int k = 0; k < 6000; ++k) {
    const bool lost =
        (k >= 1500 && k < 1503) ||
        (k >= 2000 && k < 3300); // the second pause is longer than the counter's range of 256
    if (lost) {
      continue;
    }
    ++kept;
    ASSERT_TRUE(stream->take(on_time(k), collected));
  }
  stream->finish(collected);
  EXPECT_EQ(stream->counts().lost, 1303U);
  const auto numbers = collected.numbers;
  ASSERT_EQ(numbers.size(), kept);
  EXPECT_EQ(numbers.front(), 0U);
  EXPECT_EQ(numbers.back(), 5999U);
}

TEST(SensorStream, AFrameThatComesLateIsNoRestart) {
  const auto stream = stream_of(one_message());
  Collected collected;
  ASSERT_TRUE(stream->begin(link(), collected));
  for (int k = 0; k < 6000; ++k) {
    const int swapped = k % 700 == 500 ? k + 1 : k % 700 == 501 ? k - 1 : k;
    ASSERT_TRUE(stream->take(on_time(swapped), collected));
  }
  stream->finish(collected);
  EXPECT_EQ(stream->counts().restarts, 0U);
  EXPECT_EQ(stream->counts().late, 8U);
  EXPECT_EQ(stream->counts().lost, 8U); // in the place that they would have had
  EXPECT_TRUE(collected.sessions_begun_at.empty());
  EXPECT_EQ(collected.numbers.back(), 5999U);
}

TEST(SensorStream, LeavesOutWhatFramesWaitForTheBus) {
  const auto stream = stream_of(one_message());
  Collected collected;
  ASSERT_TRUE(stream->begin(link(), collected));
  std::mt19937 random(3);
  for (int k = 0; k < 5000; ++k) {
    CanFrame frame = on_time(k);
    frame.kernel_ns += k % 3 == 0 ? 0 : std::uniform_int_distribution<>(0, 132'000)(random);
    ASSERT_TRUE(stream->take(frame, collected));
  }
  stream->finish(collected);
  const auto stamps = collected.stamps_ns;
  double worst_ns = 0.0;
  for (std::size_t k = 2000; k < stamps.size(); ++k) {
    worst_ns = std::max(worst_ns, std::abs(static_cast<double>(stamps[k] - epoch_ns) -
                                           static_cast<double>(k) * 1e6));
  }
  EXPECT_LT(worst_ns, 200.0);
}

TEST(SensorStream, JoinsFramesByTheirCounterHoweverTheyCome) {
  StreamSettings settings = one_message();
  settings.messages = {"Sample", "Second"};
  const auto stream = stream_of(settings);
  Collected collected;
  ASSERT_TRUE(stream->begin(link(), collected));
  for (int k = 0; k < 2000; k += 2) { // the frames of two neighbouring samples change places
    for (const auto& [id, counter] :
         {std::pair(292U, k), std::pair(291U, k), std::pair(291U, k + 1), std::pair(292U, k + 1)}) {
      CanFrame frame = on_time(counter);
      frame.id = id;
      frame.data[0] = static_cast<std::uint8_t>(counter % 100);
      if (counter == 1001 && id == 292) {
        continue;
      }
      ASSERT_TRUE(stream->take(frame, collected));
    }
  }
  stream->finish(collected);
  const StreamCounts counts = stream->counts();
  EXPECT_EQ(counts.samples, 1999U);
  EXPECT_EQ(counts.incomplete, 1U);
  EXPECT_EQ(counts.lost, 1U);
  for (const SampleBlock& block : collected.blocks) {
    for (std::size_t i = 0; i < block.samples; ++i) {
      EXPECT_EQ(block.values[i], block.values[block.samples + i]);
    }
  }
}

TEST(SensorStream, UsesTheAdaptersClockAndRestartsItsLineWithTheLink) {
  StreamSettings settings = one_message();
  settings.counter.clear();
  settings.hardware_stamp_point = StampPoint::end_of_frame;
  const auto stream = stream_of(settings);
  Collected collected;
  ASSERT_TRUE(stream->begin(link(), collected));
  std::mt19937 random(5);
  const auto send = [&](int k, std::int64_t hardware_zero_ns) {
    CanFrame frame = on_time(k);
    frame.hardware_ns =
        hardware_zero_ns +
        std::llround(static_cast<double>(frame.kernel_ns - epoch_ns) * (1.0 + 50e-6));
    frame.kernel_ns +=
        std::llround(1e9 * std::exponential_distribution<>(1.0 / 300e-6)(random)); // USB
    ASSERT_TRUE(stream->take(frame, collected));
  };
  for (int k = 0; k < 5000; ++k) {
    send(k, 77'000'000'000);
  }
  ASSERT_TRUE(stream->take(LinkChange{link(), true, "interface 'can0' is up"}, collected));
  for (int k = 6000; k < 11000; ++k) {
    send(k, 99'000'000'000);
  }
  stream->finish(collected);
  const auto stamps = collected.stamps_ns;
  ASSERT_EQ(stamps.size(), 10'000U);
  EXPECT_NEAR(static_cast<double>(stamps[4999] - epoch_ns), 4.999e9, 3000.0);
  EXPECT_NEAR(static_cast<double>(stamps[9999] - epoch_ns), 10.999e9, 3000.0);
  EXPECT_EQ(stream->time_source(), TimeSource::hardware_stamp);
  EXPECT_GE(stream->counts().lost, 1U);
  EXPECT_EQ(collected.descriptions.back().tick_s, 1e-6);
}

TEST(SensorStream, DoesNotTimeSamplesByAClockThatBeganAfterThem) {
  StreamSettings settings = one_message();
  settings.time_source = TimeSource::hardware_stamp;
  settings.hardware_stamp_point = StampPoint::end_of_frame;
  const auto stream = stream_of(settings);
  Collected collected;
  ASSERT_TRUE(stream->begin(link(), collected));
  const auto send = [&](int k, std::int64_t hardware_ahead_ns) {
    CanFrame frame = on_time(k);
    frame.hardware_ns = frame.kernel_ns + hardware_ahead_ns;
    ASSERT_TRUE(stream->take(frame, collected));
  };
  for (int k = 0; k < 500; ++k) { // too short for a line
    send(k, 3'000'000);
  }
  ASSERT_TRUE(stream->take(LinkChange{link(), true, "interface 'can0' is up"}, collected));
  for (int k = 500; k < 3000; ++k) {
    send(k, 0);
  }
  stream->finish(collected);
  const auto stamps = collected.stamps_ns;
  ASSERT_EQ(stamps.size(), 3000U);
  for (int k = 0; k < 3000; ++k) {
    ASSERT_NEAR(static_cast<double>(stamps[static_cast<std::size_t>(k)] - epoch_ns), k * 1e6, 10.0)
        << k;
  }
  EXPECT_EQ(collected.blocks.front().flags.front(), stamp_no_uncertainty);
  EXPECT_EQ(collected.blocks.back().flags.back(), 0);
  EXPECT_EQ(stream->counts().not_trusted, 500U);
  EXPECT_EQ(stream->counts().lost, 0U);
}

TEST(SensorStream, TrustsTheLeastDelayOfAnAdapterOnUsbLessThanThatOfAControllerOnTheHost) {
  const auto u_stamp_s = [](const std::string& kind, const std::string& device_bus,
                            std::optional<double> u_latency_s) {
    StreamSettings settings = one_message();
    settings.time_base = TimeBase::local;
    settings.bus_is_shared = false;
    settings.u_latency_s = u_latency_s;
    const auto stream = stream_of(settings);
    LinkState state = link();
    state.kind = kind;
    state.device_bus = device_bus;
    Collected collected;
    EXPECT_TRUE(stream->begin(state, collected));
    return stream->u_stamp_s();
  };
  EXPECT_NEAR(u_stamp_s("can", "pci", std::nullopt), 60e-6, 1e-6);
  EXPECT_NEAR(u_stamp_s("vcan", "", std::nullopt), 60e-6, 1e-6);
  EXPECT_NEAR(u_stamp_s("can", "usb", std::nullopt), 300e-6 / std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(u_stamp_s("can", "", std::nullopt), 300e-6 / std::sqrt(3.0), 1e-6); // a serial line
  EXPECT_NEAR(u_stamp_s("can", "usb", 5e-6), 5e-6, 1e-6);
}

TEST(SensorStream, TakesTheEndOfTheSyncForTheTimeOfASynchronousSample) {
  StreamSettings settings = one_message();
  settings.counter.clear();
  settings.time_source = TimeSource::canopen_sync;
  const auto stream = stream_of(settings);
  Collected collected;
  ASSERT_TRUE(stream->begin(link(), collected));
  for (int k = 0; k < 10; ++k) {
    CanFrame sync;
    sync.id = 0x80;
    sync.kernel_ns = epoch_ns + k * 1'000'000;
    if (k != 5) {
      ASSERT_TRUE(stream->take(sync, collected));
    }
    CanFrame answer = on_time(k);
    answer.kernel_ns += 400'000 + 1000 * k;
    ASSERT_TRUE(stream->take(answer, collected));
  }
  stream->finish(collected);
  EXPECT_EQ(stream->counts().rejected, 1U); // an answer without its SYNC has no time
  EXPECT_EQ(collected.stamps_ns.back(), epoch_ns + 9'000'000);
  EXPECT_EQ(collected.descriptions.front().stamp_instant, StampInstant::frame_end);
}

TEST(SensorStream, CountsWhatTheSocketDroppedAsLostSamples) {
  StreamSettings settings = one_message();
  settings.counter.clear();
  settings.nominal_rate_hz = 0.0;
  const auto stream = stream_of(settings);
  Collected collected;
  ASSERT_TRUE(stream->begin(link(), collected));
  ASSERT_TRUE(stream->take(on_time(0), collected));
  ASSERT_TRUE(stream->take(FramesLost{17}, collected));
  ASSERT_TRUE(stream->take(on_time(18), collected));
  stream->finish(collected);
  EXPECT_EQ(stream->counts().dropped_frames, 17U);
  EXPECT_EQ(stream->counts().lost, 17U);
}

TEST(SensorStream, BeginsANewSessionWhenTheSensorRestartsItsCounter) {
  StreamSettings settings = one_message();
  const std::string wide = "BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (0.01,0) [0|0] \"m/s^2\" S\n SG_ "
                           "counter : 16|32@1+ (1,0) [0|0] \"\" S\n";
  const auto stream = stream_of(settings, wide);
  Collected collected;
  ASSERT_TRUE(stream->begin(link(), collected));
  const auto send = [&](int k, std::uint32_t counter) {
    CanFrame frame = on_time(k);
    for (unsigned i = 0; i < 4; ++i) {
      frame.data[2 + i] = static_cast<std::uint8_t>(counter >> (8 * i));
    }
    ASSERT_TRUE(stream->take(frame, collected));
  };
  for (int k = 0; k < 3000; ++k) {
    send(k, 50'000U + static_cast<std::uint32_t>(k));
  }
  for (int k = 4000; k < 7000; ++k) {
    send(k, static_cast<std::uint32_t>(k - 4000));
  }
  stream->finish(collected);
  EXPECT_EQ(collected.sessions_begun_at.size(), 1U);
  EXPECT_EQ(stream->counts().samples, 6000U);
}

TEST(SensorStream, RefusesSettingsThatDoNotFitWithOneSentence) {
  const auto refusal = [](StreamSettings settings) {
    const auto stream =
        SensorStream::create(std::move(settings), *parse_dbc(sensor_dbc, "sensor.dbc"));
    return stream ? "accepted" : stream.error().message;
  };
  StreamSettings settings = one_message();
  settings.messages = {"Nothing"};
  EXPECT_THAT(refusal(settings),
              HasSubstr("sensor.dbc has no message 'Nothing'; it has Sample, Second"));
  settings = one_message();
  settings.messages = {"Sample", "Second"};
  settings.counter.clear();
  EXPECT_THAT(refusal(settings), HasSubstr("must be joined by 'counter' or 'time_field'"));
  settings = one_message();
  settings.time_field = "counter";
  EXPECT_THAT(refusal(settings), HasSubstr("time_field_tick_s"));
  settings = one_message();
  settings.channels = {{"z", "acceleration"}};
  EXPECT_THAT(refusal(settings), HasSubstr("no signal 'z'"));
  settings = one_message();
  settings.bit_rates = {};
  const auto stream = stream_of(settings);
  Collected collected;
  const auto begun = stream->begin(link(), collected);
  ASSERT_FALSE(begun);
  EXPECT_THAT(begun.error().message, HasSubstr("'can0' does not report its bit rate"));
}

TEST(SensorStream, FindsTheMeansAndTheGapsOfARealLog) {
  const std::filesystem::path folder = DYNCAL_CAN_DATA;
  if (!std::filesystem::exists(folder / "css-canmod-gps-imu-10hz.log")) {
    GTEST_SKIP() << "no recorded CAN log in " << folder;
  }
  const auto log = read_candump_log(folder / "css-canmod-gps-imu-10hz.log", "can0");
  ASSERT_TRUE(log) << log.error().message;
  StreamSettings settings;
  settings.messages = {"0x019"};
  settings.nominal_rate_hz = 1.0 / 0.102;
  settings.bit_rates.nominal_per_s = 500e3;
  const auto stream = SensorStream::create(settings, *read_dbc_file(folder / "css-gnss.dbc"));
  ASSERT_TRUE(stream) << stream.error().message;
  ScriptedSource source(link(), {log->frames.begin(), log->frames.end()});
  Collected collected;
  ASSERT_TRUE(source.open((*stream)->filters()));
  ASSERT_TRUE((*stream)->begin(link(), collected));
  for (bool more = true; more;) {
    std::vector<BusEvent> batch;
    more = source.read(batch, std::chrono::milliseconds(0)).value() == ReadState::more;
    for (const BusEvent& event : batch) {
      ASSERT_TRUE((*stream)->take(event, collected));
    }
  }
  (*stream)->finish(collected);
  double sum[3] = {};
  double samples = 0.0;
  for (const SampleBlock& block : collected.blocks) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      for (std::size_t i = 0; i < block.samples; ++i) {
        sum[channel] += block.values[channel * block.samples + i];
      }
    }
    samples += static_cast<double>(block.samples);
  }
  EXPECT_EQ(samples, 1669.0);
  EXPECT_NEAR(sum[0] / samples, -0.3764, 5e-5);
  EXPECT_NEAR(sum[1] / samples, 0.3417, 5e-5);
  EXPECT_NEAR(sum[2] / samples, 10.0466, 5e-5);
  // Every interval of the log longer than one and a half nominal ones is a gap of the stream, and
  // nothing else is.
  const auto stamps = collected.stamps_ns;
  const auto numbers = collected.numbers;
  std::size_t gaps = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    const bool long_interval = static_cast<double>(stamps[i] - stamps[i - 1]) > 1.5 * 0.102e9;
    // Stuffing makes the start of a frame differ from its stamp by microseconds.
    EXPECT_EQ(numbers[i] - numbers[i - 1] > 1, long_interval) << i;
    gaps += long_interval ? 1 : 0;
  }
  EXPECT_GT(gaps, 0U);
  RecordProperty("gaps", static_cast<int>(gaps));
  RecordProperty("lost", static_cast<int>((*stream)->counts().lost));
}

} // namespace
} // namespace dyncal::drivers::can
