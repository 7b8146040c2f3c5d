// What the bench's sensor with CAN output puts on its bus, received and evaluated by absolute time,
// must give what the bench says is true. The kernel's stamp is the end of the frame here, and a
// latency behind it; no time of the host's passes.
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "analysis/method/analogue_comparison.hpp"
#include "drivers/can/sensor_stream.hpp"
#include "drivers/virtual_bench/can/can_sensor.hpp"
#include "drivers/virtual_bench/model/virtual_bench.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

namespace can = drivers::can;
namespace device = drivers::virtual_bench;

constexpr std::int64_t origin_ns = 1'763'000'000'000'000'000;
constexpr double latency_s = 10e-6; // the least that the kernel needs

struct Samples : drivers::SampleSink {
  drivers::SourceDescription description;
  std::vector<std::int64_t> stamps_ns;
  std::array<std::vector<double>, 3> axes;

  void describe(const drivers::SourceDescription& now) override { description = now; }
  void begin_session() override { ADD_FAILURE() << "the sensor did not restart"; }
  void count(const drivers::SampleCounts&) override {}
  void warn(const std::string&) override {}
  void take(drivers::SampleBlock block) override {
    stamps_ns.insert(stamps_ns.end(), block.stamps_ns.begin(), block.stamps_ns.end());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto begin = block.values.begin() + static_cast<std::ptrdiff_t>(axis * block.samples);
      axes[axis].insert(axes[axis].end(), begin,
                        begin + static_cast<std::ptrdiff_t>(block.samples));
    }
  }
};

// The sensor as a bench file has it.
std::unique_ptr<can::SensorStream> receiver(const CanSensor& sensor, const CanBusKind& bus,
                                            std::optional<can::TimeSource> time_source,
                                            bool correct) {
  can::StreamSettings settings;
  settings.counter = "counter";
  settings.nominal_rate_hz = CanSensor::nominal_rate_hz;
  settings.bit_rates = bus.rates;
  settings.time_source = time_source;
  settings.correct_frame_duration = correct;
  settings.latency_s = latency_s;
  settings.u_latency_s = 2e-6;
  settings.u_utc_s = 0.1e-6;
  auto stream = can::SensorStream::create(settings, *can::parse_dbc(sensor.dbc(), "sensor.dbc"));
  EXPECT_TRUE(stream) << stream.error().message;
  return std::move(*stream);
}

class CanTruth : public testing::TestWithParam<CanBusKind> {
protected:
  CanTruth() {
    device::BenchSettings settings;
    settings.preset = *device::preset_by_name("mpu9250-ptb");
    settings.seed = 7;
    settings.acs_rate_hz = 10'000;
    settings.reference_magnitude_rel = settings.reference_phase_rad = 0.0; // of no interest here
    settings.utc_origin_ns = origin_ns;
    bench.emplace(settings);
    CanSensorSettings of_sensor;
    of_sensor.preset = settings.preset;
    of_sensor.bus = GetParam();
    of_sensor.background_load = 0.3;
    sensor.emplace(of_sensor);
    can::LinkState link;
    link.name = "can0";
    link.present = link.up = true;
    streams.push_back(receiver(*sensor, GetParam(), std::nullopt, true));
    streams.push_back(receiver(*sensor, GetParam(), can::TimeSource::kernel_stamp, true));
    streams.push_back(receiver(*sensor, GetParam(), can::TimeSource::kernel_stamp, false));
    received.resize(streams.size());
    for (std::size_t i = 0; i < streams.size(); ++i) {
      EXPECT_TRUE(streams[i]->begin(link, received[i]));
    }
  }

  void excite(const std::string& frequency_hz, double duration_s) {
    bench->set_drive({std::stod(frequency_hz), 1.0, true});
    std::exponential_distribution<> late(1.0 / 15e-6);
    const double end_s = bench->now_s() + duration_s;
    while (bench->now_s() < end_s) {
      bench->advance_to(std::min(end_s, bench->now_s() + 0.02), acs,
                        [](const device::UnitSample&) {});
      sensor->advance_to(bench->now_s(), bench->excitation(), [&](const SentFrame& sent) {
        can::CanFrame frame = sent.frame;
        frame.kernel_ns = origin_ns + std::llround((sent.end_s + latency_s + late(random)) * 1e9);
        for (std::size_t i = 0; i < streams.size(); ++i) {
          EXPECT_TRUE(streams[i]->take(frame, received[i]));
        }
      });
    }
    for (std::size_t i = 0; i < streams.size(); ++i) {
      streams[i]->finish(received[i]);
    }
  }

  // Of all axes by one of the receivers, from one second after the beginning to the end.
  std::vector<analysis::TransferPoint> evaluate(const std::string& frequency_hz,
                                                std::size_t receiver_number) {
    constexpr std::int64_t begin_ns = origin_ns + 1'500'000'000;
    std::vector<std::int64_t> acs_stamps;
    std::vector<double> reference;
    for (std::size_t i = 0; i < acs.samples(); ++i) {
      if (bench->acs().stamp_ns(acs.first_sample + i) >= begin_ns) {
        acs_stamps.push_back(bench->acs().stamp_ns(acs.first_sample + i));
        reference.push_back(acs.counts[2 * i] * bench->acs().reference_scale());
      }
    }
    Samples& samples = received[receiver_number];
    const auto skip =
        std::lower_bound(samples.stamps_ns.begin(), samples.stamps_ns.end(), begin_ns) -
        samples.stamps_ns.begin();
    analysis::AbsoluteTimeInput input{.frequency = *analysis::Frequency::parse(frequency_hz)};
    input.reference_stamps_ns = acs_stamps;
    input.reference = {"reference", reference, 0.0};
    input.dut_stamps_ns = std::span(samples.stamps_ns).subspan(static_cast<std::size_t>(skip));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      input.dut.push_back({std::string(1, "xyz"[axis]),
                           std::span(samples.axes[axis]).subspan(static_cast<std::size_t>(skip)),
                           samples.description.channels.at(axis).resolution});
    }
    input.systematic.clock_offset_s = samples.description.stamp_uncertainty_s;
    const auto result = analysis::evaluate_absolute_time(input);
    EXPECT_TRUE(result) << result.error().message;
    return result ? result->points : std::vector<analysis::TransferPoint>{};
  }

  std::optional<device::VirtualBench> bench;
  std::optional<CanSensor> sensor;
  device::AcsSamples acs;
  std::vector<std::unique_ptr<can::SensorStream>>
      streams; // by counter; by stamp; by stamp without frame duration
  std::vector<Samples> received;
  std::mt19937 random{3};
};

TEST_P(CanTruth, IsMetWithin4uOnABusyBusAndMissedByTheFramesDurationWithoutItsCorrection) {
  const std::string frequency_hz = "104";
  excite(frequency_hz, 5.0);
  const auto points = evaluate(frequency_hz, 0);
  ASSERT_EQ(points.size(), 3U);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::complex<double> truth = bench->settings().preset.axes[axis].at(104.0);
    EXPECT_NEAR(points[axis].magnitude, std::abs(truth), 4.0 * points[axis].u_magnitude) << axis;
    const double error_rad =
        std::remainder(points[axis].phase_rad - std::arg(truth), 2.0 * std::numbers::pi);
    EXPECT_LT(std::abs(error_rad), 4.0 * points[axis].u_phase_rad) << axis;
    if (axis == 2) {
      std::printf("%s: magnitude %+.6f (u %.6f), phase %+.3f mrad (u %.3f)\n",
                  GetParam().name.c_str(), points[axis].magnitude - std::abs(truth),
                  points[axis].u_magnitude, error_rad * 1e3, points[axis].u_phase_rad * 1e3);
    }
  }
  const double corrected = evaluate(frequency_hz, 1).at(2).phase_rad;
  const double uncorrected = evaluate(frequency_hz, 2).at(2).phase_rad;
  const double seems_late_s = -std::remainder(uncorrected - corrected, 2.0 * std::numbers::pi) /
                              (2.0 * std::numbers::pi * 104.0);
  std::printf("%s: without frame duration %+.2f mrad, that is %.1f us\n", GetParam().name.c_str(),
              -seems_late_s * 2.0 * std::numbers::pi * 104.0 * 1e3, seems_late_s * 1e6);
  // Eight bytes and their stuff bits: 111 ... 135 bits; can FD: 24 bytes at the higher rate between
  // two short parts at the lower one.
  const double bit_s = 1.0 / GetParam().rates.nominal_per_s;
  EXPECT_GT(seems_late_s, GetParam().fd ? 60e-6 : 109.0 * bit_s);
  EXPECT_LT(seems_late_s, GetParam().fd ? 100e-6 : 121.0 * bit_s);
}

INSTANTIATE_TEST_SUITE_P(Buses, CanTruth, testing::ValuesIn(can_bus_kinds()),
                         [](const testing::TestParamInfo<CanBusKind>& bus) {
                           std::string name = bus.param.name;
                           std::erase(name, '-');
                           return "at_" + name;
                         });

} // namespace
} // namespace dyncal::drivers::virtual_bench
