// A sensor with CAN output on the virtual bench, and the other devices on its bus.
//
// At the instants of its own clock (rate drawn within 200 ppm of nominal) the sensor measures three
// axes with the response of the preset, noise and a resolution of 0.005 m/s^2, numbers the sample
// and has its frame ready `latency_s` later. The phase in the truth file refers to the instant at
// which the frame could have begun on an idle bus: that of the reading plus the latency.
//
// Other devices send frames of 8 bytes (64 on CAN FD) at random, some with a lower id than the
// sensor's, for the given share of the bus's time. Everything drawn follows from the seed. Times
// are seconds of bench time. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "drivers/virtual_bench/can/can_bus.hpp"
#include "drivers/virtual_bench/model/bench_faults.hpp"
#include "drivers/virtual_bench/model/channel_disturbance.hpp"
#include "drivers/virtual_bench/model/excitation.hpp"
#include "drivers/virtual_bench/model/preset.hpp"
#include "drivers/virtual_bench/model/random.hpp"

namespace dyncal::drivers::virtual_bench {

struct CanBusKind {
  std::string name; // "500k", "1M", "fd-5M"
  can::BitRates rates;
  bool fd = false;
};

[[nodiscard]] const std::vector<CanBusKind>& can_bus_kinds();

struct CanSensorSettings {
  Preset preset;
  std::uint64_t seed = 1;
  CanBusKind bus;
  double background_load = 0.15; // of the bus's time
  double latency_s = 0.2e-3; // from the reading to the frame; not more than the smallest delay of
                             // the preset's axes
  double highest_level_m_s2 = 130.0;
  ChannelFaults faults;
  SampleLoss loss;
};

class CanSensor {
public:
  explicit CanSensor(const CanSensorSettings& settings);

  // Measures up to `time_s` and hands over the frames that begin on the bus before it.
  void advance_to(double time_s, const Excitation& excitation,
                  const std::function<void(const SentFrame&)>& sent);

  [[nodiscard]] double rate_hz() const { return rate_hz_; }
  // The DBC file that goes with it.
  [[nodiscard]] std::string dbc() const;

  static constexpr std::uint32_t id = 0x100;
  static constexpr double nominal_rate_hz = 500.0;

private:
  [[nodiscard]] can::CanFrame measure(double time_s, const Excitation& excitation);
  [[nodiscard]] can::CanFrame foreign_frame();
  [[nodiscard]] unsigned foreign_bytes() const { return settings_.bus.fd ? 64 : 8; }
  [[nodiscard]] double next_foreign_pause_s();

  CanSensorSettings settings_;
  CanBus bus_;
  Random noise_;
  Random traffic_;
  Random loss_;
  std::vector<ChannelDisturbance> disturbances_; // x, y, z
  double rate_hz_ = nominal_rate_hz;
  double noise_m_s2_ = 0.0;
  std::array<double, 3> offset_m_s2_{};
  double resolution_m_s2_ = 0.0;
  std::uint64_t next_sample_ = 0;
  std::uint64_t uncounted_ = 0; // samples that were lost and that its counter does not show
  can::CanFrame foreign_;       // the next of another device
  double next_foreign_s_ = 0.0;
};

} // namespace dyncal::drivers::virtual_bench
