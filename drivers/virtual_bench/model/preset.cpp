#include "drivers/virtual_bench/model/preset.hpp"

#include <cmath>
#include <numbers>

namespace dyncal::drivers::virtual_bench {
namespace {

// Published result of PTB for the z axis of an MPU-9250: Hz, magnitude, phase in degrees.
struct PublishedPoint {
  double frequency_hz;
  double magnitude;
  double phase_deg;
};

constexpr std::array<PublishedPoint, 17> ptb_points{{{10.0, 1.019167, -5.4257},
                                                     {12.5, 1.018422, -6.8018},
                                                     {16.0, 1.018071, -8.7099},
                                                     {20.0, 1.016803, -10.8727},
                                                     {25.0, 1.015281, -13.587},
                                                     {31.5, 1.012913, -17.1374},
                                                     {40.0, 1.008842, -21.7622},
                                                     {46.7, 1.005066, -25.4223},
                                                     {50.0, 1.002939, -27.18},
                                                     {53.3, 1.000545, -29.0013},
                                                     {63.0, 0.994049, -34.2362},
                                                     {80.0, 0.97718, -43.5137},
                                                     {100.0, 0.953509, -54.4004},
                                                     {125.0, 0.916235, -67.9979},
                                                     {160.0, 0.853822, -87.0253},
                                                     {200.0, 0.767631, -108.8009},
                                                     {250.0, 0.64397, -135.9848}}};
constexpr double ptb_delay_s = 1.511e-3;
constexpr double paper_delay_s = 8.1e-3;
constexpr double bma280_delay_s = 0.55e-3;

PchipTable ptb_magnitude() {
  std::vector<double> x;
  std::vector<double> y;
  for (const PublishedPoint& point : ptb_points) {
    x.push_back(point.frequency_hz);
    y.push_back(point.magnitude);
  }
  return {x, y};
}

// What the published phase has beyond the pure delay.
PchipTable ptb_residual_phase() {
  std::vector<double> x;
  std::vector<double> y;
  for (const PublishedPoint& point : ptb_points) {
    x.push_back(point.frequency_hz);
    y.push_back(point.phase_deg * std::numbers::pi / 180.0 +
                2.0 * std::numbers::pi * point.frequency_hz * ptb_delay_s);
  }
  return {x, y};
}

// A magnitude 1 + (f / corner)^2 for a mechanical path that gets more lively with frequency, or
// falling for a negative sign.
PchipTable curved_magnitude(double corner_hz, double sign) {
  std::vector<double> x;
  std::vector<double> y;
  for (double f = 1.0; f < 1100.0; f *= 1.1) {
    x.push_back(f);
    y.push_back(std::exp(sign * (f / corner_hz) * (f / corner_hz)));
  }
  return {x, y};
}

// The cross axes have gains and delays of their own, a bit off the main axis; y points the other
// way.
void add_cross_axes(Preset& preset) {
  const double delay_s = preset.axes[2].delay_s;
  preset.axes[0] = {0.0196, delay_s + 0.12e-3, curved_magnitude(900.0, 1.0), {}};
  preset.axes[1] = {-0.0174, delay_s - 0.05e-3, curved_magnitude(1200.0, -1.0), {}};
}

Preset mpu9250(const std::string& name, double delay_s, PchipTable residual_phase) {
  Preset preset;
  preset.name = name;
  preset.sensor = SensorKind::mpu9250;
  preset.sensor_name = "MPU 9250";
  preset.nominal_rate_hz = 1000.0;
  preset.mean_interval_s = 996.96e-6;
  preset.interval_sd_s = 21e-9;
  preset.counts_per_range = 32768.0;
  preset.noise_g_per_root_hz = 300e-6;
  preset.axes[2] = {1.0, delay_s, ptb_magnitude(), std::move(residual_phase)};
  add_cross_axes(preset);
  return preset;
}

Preset bma280() {
  Preset preset;
  preset.name = "bma280";
  preset.sensor = SensorKind::bma280;
  preset.sensor_name = "BMA 280";
  preset.nominal_rate_hz = 2000.0;
  preset.mean_interval_s = 485e-6;
  preset.interval_sd_s = 127e-9;
  preset.counts_per_range = 8192.0;
  preset.noise_g_per_root_hz = 120e-6;
  preset.axes[2] = {1.006, bma280_delay_s, curved_magnitude(2300.0, -1.0), {}};
  add_cross_axes(preset);
  return preset;
}

} // namespace

std::optional<Preset> preset_by_name(const std::string& name) {
  if (name == "mpu9250-paper") {
    return mpu9250(name, paper_delay_s, {});
  }
  if (name == "mpu9250-ptb") {
    return mpu9250(name, ptb_delay_s, ptb_residual_phase());
  }
  if (name == "tss") {
    Preset preset = mpu9250(name, ptb_delay_s, ptb_residual_phase());
    preset.triggered = true;
    return preset;
  }
  if (name == "bma280") {
    return bma280();
  }
  return std::nullopt;
}

std::vector<std::string> preset_names() {
  return {"mpu9250-paper", "mpu9250-ptb", "bma280", "tss"};
}

} // namespace dyncal::drivers::virtual_bench
