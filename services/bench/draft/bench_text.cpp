#include "services/bench/draft/bench_text.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "analysis/base/preferred_frequencies.hpp"
#include "services/base/toml_string.hpp"

namespace dyncal::inline bench::bench_draft {
namespace {

std::string quoted_list(const std::vector<std::string>& texts) {
  std::vector<std::string> all;
  all.reserve(texts.size());
  for (const std::string& text : texts) {
    all.push_back(toml_string(text));
  }
  return fmt::format("[{}]", fmt::join(all, ", "));
}

// A range of preferred frequencies stays one.
std::string frequencies_text(const BenchDraft& draft) {
  const std::vector<std::string>& texts = draft.frequencies_hz;
  return texts.size() == 1 && analysis::preferred_frequencies(texts.front())
             ? toml_string(texts.front())
             : quoted_list(texts);
}

// A key, bare where TOML allows it.
std::string key_of(const std::string& name) {
  const bool bare = !name.empty() && std::ranges::all_of(name, [](unsigned char letter) {
    return std::isalnum(letter) != 0 || letter == '_' || letter == '-';
  });
  return bare ? name : toml_string(name);
}

std::string channel(const std::string& source, const std::string& name) {
  return toml_string(fmt::format("{}/{}", source, name));
}

// TOML needs the point or exponent of a floating-point number.
std::string number(double value) {
  const std::string text = fmt::format("{}", value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

constexpr const char* multisine_kind =
    R"(kind = "multisine" # all frequencies at once, as lines of one waveform
)";

std::string times_of_steps(const BenchDraft& draft) {
  return fmt::format(
      R"(repeat_first = true # the first frequency once more at the end: shows a drift
settling_s = {:<13} # before every step
duration_s = {:<13} # of every step; at least three periods of the lowest frequency
)",
      number(draft.settling_s), number(draft.duration_s));
}

std::string times_of_multisine(const BenchDraft& draft) {
  return fmt::format(R"(period_s = {:<15} # of the waveform
dropped_periods = 1.0     # at the beginning of every excitation
duration_s = {:<13} # of every excitation: whole periods
)",
                     number(draft.multisine_period_s), number(draft.multisine_period_s));
}

void add_head(const BenchDraft& draft, std::string& text) {
  const bool multisine = draft.multisine_period_s > 0.0;
  text += fmt::format(R"(# Bench {}, made by 'dyncal new-bench'. Hold it against what is there:
#   dyncal check FILE        the whole file, without driving anything
#   dyncal run FILE          one run
bench = {}

[excitation]
{}# Decimal text, because 199.87 is not exact as a number.
frequencies_hz = {}
level = {:<18} # m/s^2, amplitude; or a list, one level for every frequency
# level_displacement_mm = 5.0 # within the stroke of the exciter: the smaller of both holds
repetitions = {}
{})",
                      draft.name.find('\n') == std::string::npos ? draft.name : "",
                      toml_string(draft.name), multisine ? multisine_kind : "",
                      frequencies_text(draft), number(draft.level_m_s2), draft.repetitions,
                      multisine ? times_of_multisine(draft) : times_of_steps(draft));
}

void add_generator(const BenchDraft& draft, std::string& text) {
  switch (draft.generator) {
  case GeneratorKind::none:
    text += R"(
# Nothing is driven: the run waits for a sine of every frequency in the list.
[generator]
driver = "none"
)";
    return;
  case GeneratorKind::by_hand:
    text += R"(
[generator]
driver = "by-hand"         # the run asks for every step; somebody sets the generator
)";
    break;
  case GeneratorKind::scpi:
    text += fmt::format(R"(
[generator]
driver = "scpi"            # its output drives the power amplifier
address = {}
)",
                        toml_string(draft.generator_address));
    break;
  }
  text += fmt::format(
      R"(level_per_volt = {:<9} # m/s^2 at the exciter for 1 V: MEASURE IT with a small voltage first
maximum_voltage_v = {:<6} # amplitude; a run that needs more is refused or stopped
maximum_level_m_s2 = {:<5} # what exciter and sensor can bear
)",
      number(draft.level_per_volt), number(draft.maximum_voltage_v),
      number(1.5 * draft.level_m_s2));
}

void add_can_sensor(const BenchDraft& draft, const std::string& dbc_name, std::string& text) {
  text += fmt::format(R"(
[sources.sensor]
driver = "can"
interface = {}       # set up by the system: ip link set can0 up type can bitrate 500000
dbc = {}
)",
                      toml_string(draft.interface),
                      toml_string(draft.dbc.empty() ? dbc_name : draft.dbc));
  if (draft.dbc.empty()) {
    text +=
        R"(counter = "SampleCounter"  # signal that counts samples; leave it out where there is none
channels = { AccelerationZ = "acceleration_z" }
nominal_rate_hz = 1000.0
)";
  }
  text += R"(bit_rate_per_s = 500000    # checked against the interface
# latency_s = 12e-6        # of adapter and kernel, when it was measured
# u_latency_s = 5e-6
)";
}

void add_sensor(const BenchDraft& draft, const std::string& dbc_name, std::string& text) {
  switch (draft.sensor) {
  case SensorKind::smartup:
    text += fmt::format(R"(
[sources.dau]
driver = "smartup"
listen = {}    # where the unit is told to send its datagrams; a port of its own for each bench
sensor = {}    # as the unit numbers it; 'dyncal run' lists those that send
channels = {{ Data_11 = "sync" }}    # the input of the unit that sync is connected to
nominal_rate_hz = 1000.0   # as the sensor is set; 'dyncal check' looks at it
)",
                        toml_string(draft.listen), toml_string(draft.sensor_id));
    return;
  case SensorKind::file:
    text += fmt::format(R"(
[sources.dau]
driver = "file"
path = {}       # CSV (first column t_ns), .npy or .wav; units of its columns:
units = {{ {} = "m/s^2", {} = "V" }}
)",
                        toml_string(draft.sensor_file), key_of(channel_of(draft)),
                        key_of(draft.sensor_sync));
    return;
  case SensorKind::can:
    add_can_sensor(draft, dbc_name, text);
    return;
  case SensorKind::series:
    text += fmt::format(R"(
[sources.dso]
driver = "oscilloscope"    # triggers the sensor on the zero crossing of sync
address = {}    # or "vxi11:HOST"
sync_input = 1
sync_range_v = 20.0        # peak to peak

[sources.tss]
driver = "series"
address = {}
units = {{ {} = "m/s^2" }}
)",
                        toml_string(draft.dso_address), toml_string(draft.sensor_address),
                        key_of(channel_of(draft)));
    return;
  case SensorKind::analogue:
    return; // a channel of the ACS
  }
}

void add_acs(const BenchDraft& draft, std::string& text) {
  const std::string sensor = draft.sensor == SensorKind::analogue
                                 ? fmt::format(", {} = \"V\"", key_of(channel_of(draft)))
                                 : fmt::format(", {} = \"V\"", key_of(draft.sync));
  if (draft.acs == AcsKind::file) {
    text += fmt::format(R"(
[sources.acs]
driver = "file"
path = {}
units = {{ {} = "m/s^2"{} }}
)",
                        toml_string(draft.acs_file), key_of(draft.reference), sensor);
    if (draft.sensor == SensorKind::can) {
      text +=
          "time_base = \"utc\"          # its stamps, as those of the host that has the sensor\n";
    }
    return;
  }
  text += fmt::format(R"(
[sources.acs]
driver = "socket"          # the stream of the analogue system
address = {}
nominal_rate_hz = 10000.0  # as it is set; 'dyncal check' looks at it
)",
                      toml_string(draft.acs_address));
  if (draft.sensor == SensorKind::can) {
    text += "# Its stream must say \"time_base\": \"utc\".\n";
  }
}

void add_absolute_time(const BenchDraft& draft, std::string& text) {
  std::vector<std::string> channels;
  channels.reserve(draft.dbc_channels.size() + 1);
  for (const std::string& name : draft.dbc_channels) {
    channels.push_back("sensor/" + name);
  }
  if (channels.empty()) {
    channels.emplace_back("sensor/acceleration_z");
  }
  text += fmt::format(R"(
[method]
kind = "absolute-time"     # both clocks keep UTC (GPS, PTP)
reference = {}
dut = {}
)",
                      channel("acs", draft.reference), quoted_list(channels));
}

void add_method(const BenchDraft& draft, std::string& text) {
  const std::string reference = channel("acs", draft.reference);
  switch (draft.sensor) {
  case SensorKind::smartup:
  case SensorKind::file: {
    const bool is_file = draft.sensor == SensorKind::file;
    text += fmt::format(R"(
[method]
kind = "sample-timestamping"
reference = {}
sync_acs = {}      # both systems record sync, which links their clocks
sync_dau = {}
dut = [{}]
)",
                        reference, channel("acs", draft.sync),
                        channel("dau", is_file ? draft.sensor_sync : "sync"),
                        channel("dau", channel_of(draft)));
    return;
  }
  case SensorKind::can:
    add_absolute_time(draft, text);
    return;
  case SensorKind::series:
    text += fmt::format(R"(
[method]
kind = "series-timestamping"
reference = {}
sync_acs = {}
sync_dso = "dso/sync"
dut = [{}]
shots = 5                  # of every step

[corrections]
# Measure it with 'dyncal calibrate dso-delay', and take the # away:
# dso_delay = {{ file = "dso-delay.json" }}
)",
                        reference, channel("acs", draft.sync), channel("tss", channel_of(draft)));
    return;
  case SensorKind::analogue:
    text += fmt::format(R"(
[method]
kind = "analogue"
reference = {}
dut = [{}]
)",
                        reference, channel("acs", channel_of(draft)));
    return;
  }
}

// What only the user can know is asked for, never filled in: until then results are flagged.
void add_uncertainty(const BenchDraft& draft, std::string& text) {
  if (!draft.reference_file.empty()) {
    text += draft.sensor == SensorKind::series ? "" : "\n[corrections]\n";
    text += fmt::format("reference = {}   # its certificate\n", toml_string(draft.reference_file));
  }
  text += R"(
# Standard uncertainties (k = 1). Write your own behind what is not known yet, and take the # away:
# until then results are flagged.
[uncertainty]
)";
  if (draft.reference_file.empty()) {
    text +=
        "# reference_magnitude_rel =   # of the reference; better, [corrections] reference names "
        "its file\n# reference_phase_rad =\n";
  }
  if (draft.sensor == SensorKind::smartup || draft.sensor == SensorKind::file) {
    text += "# adc_delay_s =               # of the unit's sync ADC, until it is calibrated\n";
  } else if (draft.sensor == SensorKind::series) {
    text += "# acs_rate_rel =              # of the ACS's clock\n";
  }
  text += draft.sensor == SensorKind::can
              ? "# acs_delay_s =               # of the reference's channel and the ACS's clock "
                "against UTC\n"
              : "# acs_delay_s =               # between the ACS's channels\n";
}

} // namespace

std::string bench_text(const BenchDraft& draft, const std::string& dbc_name) {
  std::string text;
  add_head(draft, text);
  add_generator(draft, text);
  add_sensor(draft, dbc_name, text);
  add_acs(draft, text);
  add_method(draft, text);
  add_uncertainty(draft, text);
  return text;
}

std::string dbc_text() {
  return R"(VERSION ""

BU_: Sensor Host

BO_ 291 Sample: 8 Sensor
 SG_ AccelerationX : 0|16@1- (0.005,0) [-160|160] "m/s^2" Host
 SG_ AccelerationY : 16|16@1- (0.005,0) [-160|160] "m/s^2" Host
 SG_ AccelerationZ : 32|16@1- (0.005,0) [-160|160] "m/s^2" Host
 SG_ SampleCounter : 48|16@1+ (1,0) [0|65535] "" Host
)";
}

} // namespace dyncal::inline bench::bench_draft
