#include "drivers/virtual_bench/can/can_sensor.hpp"
#include "drivers/can/time/frame_duration.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace dyncal::drivers::virtual_bench {
namespace {

namespace device = drivers::virtual_bench;
using can::CanFrame;

constexpr double usual_resolution_m_s2 = 0.005;
constexpr double counts_per_range = 32768.0;
constexpr double max_rate_error = 200e-6;
constexpr double standard_gravity = 9.80665;
constexpr std::uint8_t classic_bytes = 8;
constexpr std::uint8_t fd_bytes = 24; // three axes and a counter, and what else such a sensor sends

void put_16_bit(CanFrame& frame, std::size_t byte, std::uint16_t value) {
  frame.data[byte] = static_cast<std::uint8_t>(value);
  frame.data[byte + 1] = static_cast<std::uint8_t>(value >> 8U);
}

// Shortest text that reads back as the same number.
std::string shortest(double value) {
  return fmt::format("{}", value);
}

} // namespace

const std::vector<CanBusKind>& can_bus_kinds() {
  static const std::vector<CanBusKind> kinds{
      {"500k", {500e3, 0.0}, false}, {"1M", {1e6, 0.0}, false}, {"fd-5M", {1e6, 5e6}, true}};
  return kinds;
}

CanSensor::CanSensor(const CanSensorSettings& settings)
    : settings_(settings), bus_(settings.bus.rates), noise_(settings.seed, "CAN sensor noise"),
      traffic_(settings.seed, "CAN traffic"), loss_(settings.seed, "CAN sensor loss"),
      disturbances_(3, ChannelDisturbance(settings.seed, "sensor", settings.faults,
                                          settings.highest_level_m_s2)),
      resolution_m_s2_(settings.faults.range > 0.0 ? settings.faults.range / counts_per_range
                                                   : usual_resolution_m_s2) {
  device::Random draws(settings.seed, "CAN sensor");
  rate_hz_ = nominal_rate_hz * (1.0 + draws.uniform(-max_rate_error, max_rate_error));
  noise_m_s2_ =
      settings.preset.noise_g_per_root_hz * standard_gravity * std::sqrt(0.5 * nominal_rate_hz);
  for (double& offset : offset_m_s2_) {
    offset = draws.normal(0.25);
  }
  offset_m_s2_[2] += standard_gravity;
  foreign_ = foreign_frame();
  next_foreign_s_ = next_foreign_pause_s();
}

CanFrame CanSensor::measure(double time_s, const device::Excitation& excitation) {
  CanFrame frame;
  frame.id = id;
  frame.fd = frame.bit_rate_switch = settings_.bus.fd;
  frame.length = settings_.bus.fd ? fd_bytes : classic_bytes;
  for (std::size_t axis = 0; axis < offset_m_s2_.size(); ++axis) {
    const device::AxisResponse& response = settings_.preset.axes[axis];
    const device::Motion motion =
        excitation.motion(time_s - (response.delay_s - settings_.latency_s));
    const double value = disturbances_[axis].cut(excitation.acceleration(
                             motion, device::harmonic_gains(response, motion.frequency_hz))) +
                         offset_m_s2_[axis] + noise_.normal(noise_m_s2_) +
                         disturbances_[axis].added(time_s, motion);
    const double counts = disturbances_[axis].held(
        std::clamp(std::rint(value / resolution_m_s2_), -counts_per_range, counts_per_range - 1.0),
        time_s);
    put_16_bit(frame, 2 * axis, static_cast<std::uint16_t>(static_cast<std::int16_t>(counts)));
  }
  put_16_bit(frame, 6, static_cast<std::uint16_t>(next_sample_ - uncounted_));
  return frame;
}

CanFrame CanSensor::foreign_frame() {
  CanFrame frame;
  const bool before_the_sensor = traffic_.uniform() < 0.3;
  frame.id = (before_the_sensor ? 0x020U : 0x300U) +
             static_cast<std::uint32_t>(traffic_.uniform(0.0, 32.0));
  frame.fd = frame.bit_rate_switch = settings_.bus.fd;
  frame.length = static_cast<std::uint8_t>(foreign_bytes());
  for (std::size_t byte = 0; byte < frame.length; ++byte) {
    frame.data[byte] = static_cast<std::uint8_t>(traffic_.uniform(0.0, 256.0));
  }
  return frame;
}

// Exponential pauses: devices that know nothing of each other.
double CanSensor::next_foreign_pause_s() {
  if (settings_.background_load <= 0.0) {
    return 1e9;
  }
  const double frame_s = can::frame_duration_s(foreign_, settings_.bus.rates);
  return -std::log(1.0 - traffic_.uniform()) * frame_s / settings_.background_load;
}

void CanSensor::advance_to(double time_s, const device::Excitation& excitation,
                           const std::function<void(const SentFrame&)>& sent) {
  for (double at_s = static_cast<double>(next_sample_) / rate_hz_; at_s < time_s;
       at_s = static_cast<double>(next_sample_) / rate_hz_) {
    if (loss_.happens(settings_.loss.probability)) {
      uncounted_ += settings_.loss.counted ? 0 : 1;
    } else {
      bus_.offer(measure(at_s, excitation), at_s + settings_.latency_s);
    }
    ++next_sample_;
  }
  for (; next_foreign_s_ < time_s; next_foreign_s_ += next_foreign_pause_s()) {
    bus_.offer(foreign_, next_foreign_s_);
    foreign_ = foreign_frame();
  }
  while (const auto frame = bus_.next_before(time_s)) {
    sent(*frame);
  }
}

std::string CanSensor::dbc() const {
  std::string text = "VERSION \"\"\nBU_: Sensor\n";
  text += "BO_ " + std::to_string(id) + " Sample: " + (settings_.bus.fd ? "24" : "8") + " Sensor\n";
  const char* axes[] = {"acceleration_x", "acceleration_y", "acceleration_z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    text += std::string(" SG_ ") + axes[axis] + " : " + std::to_string(16 * axis) + "|16@1- (" +
            shortest(resolution_m_s2_) + ",0) [" + shortest(-counts_per_range * resolution_m_s2_) +
            "|" + shortest((counts_per_range - 1.0) * resolution_m_s2_) + "] \"m/s^2\" Host\n";
  }
  text += " SG_ counter : 48|16@1+ (1,0) [0|65535] \"\" Host\n";
  text += "BA_DEF_ BO_ \"VFrameFormat\" ENUM "
          "\"StandardCAN\",\"ExtendedCAN\",\"reserved\",\"J1939PG\",\"reserved\",\"reserved\","
          "\"reserved\","
          "\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\","
          "\"reserved\",\"StandardCAN_FD\",\"ExtendedCAN_FD\";\n";
  text += "BA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\n";
  if (settings_.bus.fd) {
    text += "BA_ \"VFrameFormat\" BO_ " + std::to_string(id) + " 14;\n";
  }
  return text;
}

} // namespace dyncal::drivers::virtual_bench
