#include "services/programs/demo/demo_bench.hpp"

#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/interferometer/air_wavelength.hpp"

namespace dyncal::inline programs {
namespace {

std::vector<std::string> quoted(const std::vector<std::string>& texts) {
  std::vector<std::string> result;
  for (const std::string& text : texts) {
    result.push_back('"' + text + '"');
  }
  return result;
}

constexpr const char* stamped_sources = R"([sources.dau]
driver = "smartup"
listen = "{dau}"
sensor = "0xbccb0100"
channels = {{ Data_11 = "sync" }}
time_base = "local"

[sources.acs]
driver = "socket"
address = "{acs}"

[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
temperature = "dau/temperature"

[corrections]
adc = {{ file = "adc.json", channel = "ADC1", phase_sign = "lag" }}
)";

// The raw signals stay between the ACS and dyncal-acs, which publishes the displacement.
constexpr const char* laser_sources = R"([sources.dau]
driver = "smartup"
listen = "{dau}"
sensor = "0xbccb0100"
channels = {{ Data_11 = "sync" }}
time_base = "local"

[sources.acs]
driver = "socket"
address = "{acs}"

[sources.acs.interferometer]
u1 = "u1"
u2 = "u2"
channel = "displacement"
wavelength_vacuum_nm = {laser_nm}   # a He-Ne laser that runs freely
u_wavelength_rel = {u_laser}
detector_bandwidth_hz = {bandwidth}
u_skew_s = {u_skew}
output_rate_hz = 50000   # of 500000 that the ACS records

[sources.acs.interferometer.air]
temperature_degc = {degc}
pressure_pa = {pa}
humidity_rel = {humidity}
u_temperature_k = {u_k}
u_pressure_pa = {u_pa}
u_humidity_rel = {u_humidity}

[method]
kind = "sample-timestamping"
reference = "acs/displacement"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
temperature = "dau/temperature"

[corrections]
adc = {{ file = "adc.json", channel = "ADC1", phase_sign = "lag" }}
)";

constexpr analysis::Air laser_air{.temperature_c = 23.0};
constexpr analysis::AirUncertainty u_laser_air{
    .u_temperature_k = 0.5, .u_pressure_pa = 100.0, .u_relative_humidity = 0.1};
constexpr double detector_bandwidth_hz = 20e6;
constexpr double u_skew_s = 1e-9;

constexpr const char* triggered_sources = R"([sources.dso]
driver = "oscilloscope"
address = "{dso}"

[sources.tss]
driver = "series"
address = "{tss}"
units = {{ acceleration_z = "m/s^2" }}

[sources.acs]
driver = "socket"
address = "{acs}"

[method]
kind = "series-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dso = "dso/sync"
dut = ["tss/acceleration_z"]
shots = 5
trigger_phase_correction = {correction}

[corrections]
dso_delay = {{ file = "dso-delay.json" }}
)";

// The virtual sensor's frames reach the kernel within some 10 us of their end, and everything on
// the virtual bench keeps this host's clock.
constexpr const char* can_source = R"([sources.can]
driver = "can"
interface = "{interface}"
dbc = "sensor.dbc"
counter = "counter"
nominal_rate_hz = 500.0
bit_rate_per_s = {bit_rate}
{data_bit_rate}latency_s = 10e-6
u_latency_s = 20e-6
u_utc_s = 0.1e-6

[sources.acs]
driver = "socket"
address = "{acs}"
)";

constexpr const char* absolute_time_method = R"(
[method]
kind = "absolute-time"
reference = "acs/reference"
sync_acs = "acs/sync"
dut = ["can/acceleration_x", "can/acceleration_y", "can/acceleration_z"]
)";

constexpr const char* sync_beside_method = R"(
[sources.dau]
driver = "smartup"
listen = "{dau}"
sensor = "0xbccb0100"
channels = {{ Data_11 = "sync" }}

[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["can/acceleration_x", "can/acceleration_y", "can/acceleration_z"]

[corrections]
adc = {{ file = "adc.json", channel = "ADC1", phase_sign = "lag" }}
)";

std::string sources_of(const DemoPreset& preset, const DemoAddresses& addresses) {
  const auto filled = [&](const std::string& text) {
    return fmt::format(
        fmt::runtime(text), fmt::arg("dau", addresses.dau_listen), fmt::arg("acs", addresses.acs),
        fmt::arg("dso", addresses.oscilloscope), fmt::arg("tss", addresses.sensor),
        fmt::arg("interface", addresses.can_interface),
        fmt::arg("bit_rate", addresses.can_bus == "500k" ? 500000 : 1000000),
        fmt::arg("data_bit_rate",
                 addresses.can_bus == "fd-5M" ? "data_bit_rate_per_s = 5000000\n" : ""),
        fmt::arg("correction", preset.trigger_phase_correction),
        fmt::arg("laser_nm", analysis::helium_neon_vacuum_wavelength_m * 1e9),
        fmt::arg("u_laser", analysis::helium_neon_u_rel), fmt::arg("degc", laser_air.temperature_c),
        fmt::arg("pa", laser_air.pressure_pa), fmt::arg("humidity", laser_air.relative_humidity),
        fmt::arg("u_k", u_laser_air.u_temperature_k), fmt::arg("u_pa", u_laser_air.u_pressure_pa),
        fmt::arg("u_humidity", u_laser_air.u_relative_humidity),
        fmt::arg("bandwidth", detector_bandwidth_hz), fmt::arg("u_skew", u_skew_s));
  };
  switch (preset.can) {
  case DemoPreset::CanLink::absolute_time:
    return filled(std::string(can_source) + absolute_time_method);
  case DemoPreset::CanLink::sync_beside:
    return filled(std::string(can_source) + sync_beside_method);
  case DemoPreset::CanLink::none:
    break;
  }
  return filled(preset.triggered ? triggered_sources
                : preset.laser   ? laser_sources
                                 : stamped_sources);
}

} // namespace

const std::vector<DemoPreset>& demo_presets() {
  static const std::vector<DemoPreset> presets{
      {.name = "mpu9250-paper",
       .shows = "an MPU-9250 as in the paper: delay 8.1 ms, sample interval 996.96 us with its "
                "strange histogram",
       .frequencies_hz = {"10", "12.5", "16", "20", "25", "31.5", "40", "46.7", "50", "53.3", "63",
                          "80", "100", "125", "160", "180", "200"},
       .levels_m_s2 = {2.5, 2.5, 5, 5, 10, 10, 20, 50, 50, 50, 100, 100, 100, 100, 100, 100, 100}},
      {.name = "mpu9250-ptb",
       .shows =
           "an MPU-9250 with the response that a national institute has published: delay 1.511 ms",
       .frequencies_hz = {"10", "12.5", "16", "20", "25", "31.5", "40", "46.7", "50", "53.3", "63",
                          "80", "100", "125", "160", "200", "250"},
       .levels_m_s2 = {2.75, 2.76, 5.57, 5.59, 11.28, 11.43, 23.25, 58.54, 58.76, 59.09, 115.4,
                       119.2, 122.9, 125.0, 126.8, 126.6, 126.1}},
      {.name = "bma280",
       .shows = "a BMA280: sample interval 485 us, a late and an early sample every 2200",
       .frequencies_hz = {"10", "20", "40", "80", "160", "315", "500"},
       .levels_m_s2 = {5, 10, 20, 50, 100, 100, 100}},
      {.name = "tss",
       .shows = "a sensor that records a series after the trigger of an oscilloscope, series time "
                "stamping",
       .frequencies_hz = {"10", "20", "40", "80", "125", "200"},
       .levels_m_s2 = {2.75, 5.5, 23, 100, 100, 100},
       .repetitions = 1,
       .triggered = true},
      // At 50 mm/s there are three samples to a fringe.
      {.name = "laser",
       .shows = "an MPU-9250 against a laser interferometer: two signals in quadrature at 500 kS/s",
       .frequencies_hz = {"10", "16", "25", "40", "63", "80", "100", "125", "160", "250"},
       .levels_m_s2 = {2.5, 5, 8, 12.5, 20, 25, 31.5, 40, 50, 80},
       .repetitions = 2,
       .laser = true},
      {.name = "can",
       .shows = "a sensor with CAN output on a busy bus, stamped in UTC as the analogue system is: "
                "absolute time",
       .frequencies_hz = {"10", "20", "40", "80", "125"},
       .levels_m_s2 = {2.75, 5.5, 23, 100, 100},
       .repetitions = 1,
       .duration_s = 2.0,
       .can = DemoPreset::CanLink::absolute_time},
      {.name = "can-sync",
       .shows = "a sensor with CAN output; a unit beside it samples sync on the same time scale",
       .frequencies_hz = {"10", "20", "40", "80", "125"},
       .levels_m_s2 = {2.75, 5.5, 23, 100, 100},
       .repetitions = 1,
       .duration_s = 2.0,
       .can = DemoPreset::CanLink::sync_beside},
  };
  return presets;
}

std::vector<std::string> keep_frequencies(DemoPreset& preset, double first_hz, double last_hz) {
  std::vector<std::string> left_out;
  std::vector<std::string> frequencies_hz;
  std::vector<double> levels_m_s2;
  for (std::size_t i = 0; i < preset.frequencies_hz.size(); ++i) {
    const std::string& text = preset.frequencies_hz[i];
    const double frequency_hz = std::strtod(text.c_str(), nullptr);
    if (frequency_hz < first_hz || frequency_hz > last_hz) {
      left_out.push_back(text);
      continue;
    }
    frequencies_hz.push_back(text);
    levels_m_s2.push_back(preset.levels_m_s2[i]);
  }
  preset.frequencies_hz = std::move(frequencies_hz);
  preset.levels_m_s2 = std::move(levels_m_s2);
  return left_out;
}

std::vector<std::pair<std::string, std::string>> laser_options() {
  const auto in_air =
      analysis::wavelength_in_air(analysis::helium_neon_vacuum_wavelength_m,
                                  analysis::helium_neon_u_rel, laser_air, u_laser_air);
  return {{"--interferometer", fmt::format("{}", in_air->wavelength_m * 1e9)},
          {"--wavelength-u-rel", fmt::format("{}", in_air->u_rel)},
          {"--detector-bandwidth", fmt::format("{}", detector_bandwidth_hz)},
          {"--skew-u", fmt::format("{}", u_skew_s)}};
}

std::string demo_bench_file(const DemoPreset& preset, const std::string& bench,
                            const DemoAddresses& addresses, const DemoUncertainty& uncertainty) {
  const std::string sources = sources_of(preset, addresses);
  return fmt::format(
      R"(# Written by "dyncal demo"; a bench of your own looks the same.
bench = "{bench}"

[excitation]
frequencies_hz = [{frequencies}]
level = [{levels}]   # m/s^2
axis = "z"           # excited; channels along x and y lie across it
transverse_motion = {{ ratio = 0.0, source = "the virtual exciter moves along one axis" }}
repetitions = {repetitions}
settling_s = {settling}
duration_s = {duration}

[generator]
driver = "scpi"
address = "{generator}"
level_per_volt = 50.0   # m/s^2 per V

{sources}
[uncertainty]
reference_magnitude_rel = {u_magnitude}
reference_phase_rad = {u_phase}
acs_rate_rel = {u_rate}
{u_delay})",
      fmt::arg("bench", bench),
      fmt::arg("frequencies", fmt::join(quoted(preset.frequencies_hz), ", ")),
      fmt::arg("levels", fmt::join(preset.levels_m_s2, ", ")),
      fmt::arg("repetitions", preset.repetitions), fmt::arg("settling", preset.settling_s),
      fmt::arg("duration", preset.duration_s), fmt::arg("generator", addresses.generator),
      fmt::arg("sources", sources), fmt::arg("u_magnitude", uncertainty.reference_magnitude_rel),
      fmt::arg("u_phase", uncertainty.reference_phase_rad),
      fmt::arg("u_rate", uncertainty.acs_rate_rel),
      // The virtual ACS samples its channels at once. For absolute time the key would speak of its
      // clock, which describes itself.
      fmt::arg("u_delay",
               preset.can == DemoPreset::CanLink::absolute_time ? "" : "acs_delay_s = 1e-8\n"));
}

} // namespace dyncal::inline programs
