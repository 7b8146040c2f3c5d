#include "drivers/virtual_bench/model/virtual_bench.hpp"

#include <cmath>
#include <numbers>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr double widest_range_g = 1024.0;

// The day of the paper's publication; benches of different seeds live at different times of it.
constexpr std::int64_t unit_day_ns = 1'631'836'800 * second_ns;

BenchSettings with_response(BenchSettings settings) {
  if (settings.response) {
    settings.preset.axes[2] = settings.response->response;
  }
  return settings;
}

ExciterModel draw_exciter(const BenchSettings& settings) {
  Random random(settings.seed, "exciter");
  ExciterModel exciter;
  exciter.acceleration_per_volt = VirtualBench::level_per_volt * settings.faults.exciter_gain;
  if (settings.faults.ring_down_s > 0.0) {
    exciter.ring_down_s = settings.faults.ring_down_s;
  }
  exciter.wandering_part = settings.faults.wandering.part;
  exciter.wandering_period_s = settings.faults.wandering.period_s;
  exciter.second_harmonic = std::pow(10.0, random.uniform(-52.0, -42.0) / 20.0);
  exciter.third_harmonic = std::pow(10.0, random.uniform(-60.0, -48.0) / 20.0);
  exciter.second_phase_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
  exciter.third_phase_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
  return exciter;
}

SyncAdcModel draw_adc(std::uint64_t seed) {
  Random random(seed, "sync ADC");
  SyncAdcModel adc;
  adc.gain *= 1.0 + random.normal(2e-4);
  adc.lag_s += random.normal(5e-9);
  return adc;
}

// Bench time 0.
std::int64_t start_utc_ns(std::uint64_t seed) {
  Random random(seed, "unit epoch");
  return unit_day_ns + std::llround(random.uniform(0.0, 8e13));
}

AcsSettings acs_settings(const BenchSettings& settings) {
  Random random(settings.seed, "ACS epoch");
  AcsSettings acs;
  acs.seed = settings.seed;
  acs.rate_hz = settings.acs_rate_hz;
  acs.origin_ns = std::llround(
      random.uniform(0.0, 1e15)); // counts from when it was switched on, up to 11 days ago
  const bool has_own_clock = settings.acs_pulses && !settings.acs_utc; // which pulses tell of UTC
  if (settings.acs_utc || (settings.utc_origin_ns && !has_own_clock)) {
    acs.utc = true;
    acs.origin_ns = settings.utc_origin_ns.value_or(start_utc_ns(settings.seed));
  }
  if (settings.utc_origin_ns && !has_own_clock) {
    acs.max_rate_error = 0.0;
  }
  acs.sync_is_first_output = settings.sync_is_first_output;
  acs.highest_level_m_s2 = settings.highest_level_m_s2;
  acs.sync_amplitude_v = VirtualBench::sync_amplitude_v;
  acs.reference_magnitude_rel = settings.reference_magnitude_rel;
  acs.reference_phase_rad = settings.reference_phase_rad;
  acs.reference_faults = settings.faults.reference;
  acs.sync_faults = settings.faults.sync_acs;
  acs.loss = settings.faults.acs_loss;
  acs.interferometer = settings.interferometer;
  if (settings.acs_pulses) {
    acs.pulses_utc_origin_ns = settings.utc_origin_ns.value_or(start_utc_ns(settings.seed));
  }
  return acs;
}

SensorUnitSettings unit_settings(const BenchSettings& settings, const SyncAdcModel& adc) {
  SensorUnitSettings unit;
  unit.preset = settings.preset;
  unit.seed = settings.seed;
  unit.start_ns = settings.utc_origin_ns.value_or(start_utc_ns(settings.seed));
  unit.highest_level_m_s2 = settings.highest_level_m_s2;
  if (settings.response) { // of a sensor that is made for these levels
    unit.largest_magnitude = settings.response->largest_magnitude;
    unit.widest_range_g = widest_range_g;
  }
  unit.thermal_cycle_s = settings.thermal_cycle_s;
  unit.sync_amplitude_v = VirtualBench::sync_amplitude_v;
  unit.sync_is_first_output = settings.sync_is_first_output;
  unit.adc = adc;
  unit.sensor_faults = settings.faults.sensor;
  unit.delay_change = settings.faults.delay_change;
  unit.sync_faults = settings.faults.sync_dau;
  unit.loss = settings.faults.sensor_loss;
  unit.stamp_faults = settings.faults.stamps;
  unit.fifo_samples = settings.faults.fifo_samples;
  return unit;
}

} // namespace

VirtualBench::VirtualBench(const BenchSettings& settings)
    : settings_(with_response(settings)), exciter_(draw_exciter(settings)),
      adc_(draw_adc(settings.seed)), excitation_(exciter_), acs_(acs_settings(settings_)),
      unit_(unit_settings(settings_, adc_)) {}

void VirtualBench::advance_to(double time_s, AcsSamples& acs,
                              const std::function<void(const UnitSample&)>& unit) {
  acs_.sample_until(time_s, excitation_, acs);
  while (const auto sample = unit_.next_before(time_s, excitation_)) {
    unit(*sample);
  }
  now_s_ = time_s;
}

} // namespace dyncal::drivers::virtual_bench
