// A sensor on CAN behind a played USB adapter, as a test hears it: every sample with the instant at
// which its frame began.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/can/bus/socketcan_source.hpp"
#include "drivers/can/sensor_stream.hpp"
#include "tests/can/gs_usb_adapter.hpp"
#include "tests/can/kernel_can.hpp"

namespace dyncal::tests {

// Not at an instant that depends on how often somebody has looked at the clock, which costs
// simulated time.
inline std::int64_t whole_ms(std::int64_t at_ns) {
  return at_ns - at_ns % 1'000'000;
}

inline const std::string sensor_dbc =
    "BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (0.01,0) [0|0] \"m/s^2\" S\n"
    " SG_ counter : 16|8@1+ (1,0) [0|0] \"\" S\n SG_ serial : 24|32@1+ (1,0) [0|0] \"m/s^2\" S\n";

struct Sample {
  std::uint64_t number = 0;
  std::size_t serial = 0; // by the sensor's own count of all that it has sent
  std::int64_t stamp_ns = 0;
  double u_ns = 0.0;
  std::uint8_t flags = 0;
};

struct Samples : drivers::SampleSink {
  std::vector<Sample> all;
  drivers::SourceDescription description;

  void describe(const drivers::SourceDescription& said) override { description = said; }
  void begin_session() override { ADD_FAILURE() << "the sensor did not restart"; }
  void count(const drivers::SampleCounts&) override {}
  void warn(const std::string&) override {}
  void take(drivers::SampleBlock block) override {
    for (std::size_t i = 0; i < block.samples; ++i) {
      all.push_back({block.first_sample + i,
                     static_cast<std::size_t>(std::llround(block.values[block.samples + i])),
                     block.stamps_ns[i], static_cast<double>(block.stamp_uncertainty_ns[i]),
                     block.flags[i]});
    }
  }
  // Numbers that are missing between the samples.
  [[nodiscard]] std::uint64_t missing() const {
    return all.empty() ? 0 : all.back().number - all.front().number + 1 - all.size();
  }
};

// FNV-1a.
class Digest {
public:
  template <class Value>
  void add(Value value) {
    std::array<std::uint8_t, sizeof value> bytes{};
    std::memcpy(bytes.data(), &value, sizeof value);
    for (const std::uint8_t byte : bytes) {
      digest_ = (digest_ ^ byte) * 0x100000001B3U;
    }
  }
  [[nodiscard]] std::uint64_t value() const { return digest_; }

private:
  std::uint64_t digest_ = 0xCBF29CE484222325U;
};

// Plugged in, opened, heard, and held against the truth in this order.
class PlayedSensor : public testing::Test {
protected:
  void plug_in(const GsUsbSettings& settings, const std::string& bit_timing) {
    played = settings;
    timing = bit_timing;
    adapter = std::make_unique<GsUsbAdapter>(settings);
    adapter->set_up(0, timing);
    sensor.channels = {{"x", "x"}, {"serial", "serial"}};
    sensor.hardware_stamp_point = settings.stamp_point;
    sensor.latency_s = settings.min_latency_s;
    sensor.u_latency_s = 0.5e-6;
    sensor.bus_is_shared = false;
    sensor.time_base = drivers::TimeBase::local;
  }

  void open() {
    source.emplace(on(adapter->name(0)));
    auto made = drivers::can::SensorStream::create(
        sensor, *drivers::can::parse_dbc(sensor_dbc, "sensor.dbc"));
    ASSERT_TRUE(made) << made.error().message;
    stream = std::move(*made);
    const auto link = source->open(stream->filters());
    ASSERT_TRUE(link) << link.error().message;
    ASSERT_TRUE(stream->begin(*link, samples));
    next_start_ns = whole_ms(now_ns() + second_ns / 100);
  }

  [[nodiscard]] CanFrame next_frame() const {
    CanFrame frame;
    frame.id = 291;
    frame.length = 8;
    const auto x =
        static_cast<std::int16_t>(1000.0 * std::sin(0.1 * static_cast<double>(starts_ns.size())));
    const auto serial = static_cast<std::uint32_t>(starts_ns.size());
    std::memcpy(&frame.data[0], &x, sizeof x);
    frame.data[2] = static_cast<std::uint8_t>(serial);
    std::memcpy(&frame.data[3], &serial, sizeof serial);
    return frame;
  }

  // The sensor sends `wanted` samples at its rate, and everything that comes is taken. It has
  // counted on meanwhile.
  void send(std::size_t wanted) {
    const auto interval_ns = static_cast<std::int64_t>(std::llround(1e9 / rate_hz));
    constexpr std::size_t at_once = 64;
    for (; next_start_ns < now_ns(); next_start_ns += interval_ns) {
      starts_ns.push_back(next_start_ns);
    }
    for (std::size_t sent = 0; sent < wanted;) {
      for (std::size_t i = 0; i < at_once && sent < wanted; ++i, ++sent) {
        adapter->put(next_frame(), next_start_ns);
        starts_ns.push_back(next_start_ns);
        next_start_ns += interval_ns;
      }
      take_until(next_start_ns);
    }
  }

  void take_until(std::int64_t end_ns) {
    for (std::int64_t left_ns = end_ns - now_ns(); left_ns > 0; left_ns = end_ns - now_ns()) {
      std::vector<BusEvent> events;
      ASSERT_TRUE(source->read(events, std::chrono::milliseconds(left_ns / 1'000'000 + 1)));
      for (const BusEvent& event : events) {
        const auto taken = stream->take(event, samples);
        ASSERT_TRUE(taken) << taken.error().message;
        note_stamp(event);
      }
    }
  }

  // The adapter's interval from frame to frame; the kernel sets its clock anew with every link.
  void note_stamp(const BusEvent& event) {
    const auto* frame = std::get_if<CanFrame>(&event);
    if (frame != nullptr && last_hardware_ns) {
      digest.add(frame->hardware_ns - *last_hardware_ns);
    }
    last_hardware_ns.reset();
    if (frame != nullptr) {
      last_hardware_ns = frame->hardware_ns;
    }
  }

  void finish() {
    take_until(now_ns() + second_ns / 100); // the last on their way
    stream->finish(samples);
    EXPECT_EQ(samples.all.size() + samples.missing(), starts_ns.size());
    EXPECT_EQ(stream->counts().lost, samples.missing());
  }

  // Every sample is stamped with the start of its frame, but those few, with a flag, for which a
  // link that went down left no clock.
  void expect_true_stamps(std::size_t max_flagged = 0, double max_in_u = 4.0) {
    std::size_t with_flag = 0;
    double worst_in_u = 0.0;
    double worst_ns = 0.0;
    double squares = 0.0;
    std::size_t beyond_2u = 0;
    for (const Sample& sample : samples.all) {
      if (sample.flags != 0) {
        ++with_flag;
        continue;
      }
      const double error_ns = static_cast<double>(sample.stamp_ns - starts_ns.at(sample.serial));
      squares += error_ns * error_ns;
      worst_ns = std::max(worst_ns, std::abs(error_ns));
      worst_in_u = std::max(worst_in_u, std::abs(error_ns) / sample.u_ns);
      beyond_2u += std::abs(error_ns) > 2.0 * sample.u_ns ? 1 : 0;
    }
    const auto trusted = static_cast<double>(samples.all.size() - with_flag);
    std::printf("%zu samples, error rms %.2f us, largest %.2f us, %.2f u, %.1f %% beyond 2 u, %zu "
                "flagged\n",
                samples.all.size(), std::sqrt(squares / trusted) * 1e-3, worst_ns * 1e-3,
                worst_in_u, 100.0 * static_cast<double>(beyond_2u) / trusted, with_flag);
    EXPECT_GT(trusted, 0.0);
    max_error_ns = worst_ns;
    EXPECT_LT(worst_in_u, max_in_u);
    EXPECT_LE(with_flag, max_flagged);
  }

  double rate_hz = 1000.0;
  GsUsbSettings played;
  std::string timing;
  std::unique_ptr<GsUsbAdapter> adapter;
  drivers::can::StreamSettings sensor;
  std::optional<drivers::can::SocketCanSource> source;
  std::unique_ptr<drivers::can::SensorStream> stream;
  Samples samples;
  std::vector<std::int64_t> starts_ns; // of all frames, in bench time
  std::int64_t next_start_ns = 0;
  double max_error_ns = 0.0; // of a stamp without flag
  Digest digest;             // of what came
  std::optional<std::int64_t> last_hardware_ns;
};

inline GsUsbSettings drifting(double ppm) {
  GsUsbSettings settings;
  settings.clock_ppm = ppm;
  return settings;
}

} // namespace dyncal::tests
