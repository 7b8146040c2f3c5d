// `dyncal calibrate dso-delay`: the delay of an oscilloscope's trigger output, in the set-up of
// paper section 2.4: the sync line on one input, the trigger output fed back to another
// (analysis/instrument/trigger_delay.hpp).
//
// Takes shots, prints delay, uncertainty and histogram, and writes them as JSON: the file that
// [corrections] dso_delay = { file = ... } of a bench file names
// (services/bench/file/bench_tables.hpp). With a generator's address the generator is set and
// its output switched on and off; otherwise the operator does that. A shot that fails is repeated,
// up to as many failures as shots. Belongs to one thread.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "analysis/instrument/trigger_delay.hpp"
#include "drivers/dso/oscilloscope.hpp"
#include "drivers/generator/scpi_generator.hpp"
#include "drivers/link/stop_signal.hpp"
#include "services/base/device_error.hpp"
#include "services/base/json_text.hpp"
#include "services/base/output_file.hpp"
#include "services/base/printable_text.hpp"
#include "services/programs/command/command.hpp"
#include "services/run/output_guard.hpp"
#include "services/views/report/expanded_uncertainty.hpp"
#include "services/views/report/json_number.hpp"

namespace dyncal::inline programs {
namespace {

struct CalibrateDsoDelayOptions {
  std::string oscilloscope;     // address, see drivers/link/scpi_transport.hpp
  std::string family;           // of the oscilloscope; empty: by its identity
  std::string generator;        // address; empty: set by hand
  std::string by = "rectangle"; // or "sine"
  std::string frequency_hz = "1000";
  double amplitude_v = 0.05; // of the generator, zero to peak
  int sync_input = 1;
  int output_input = 2;
  double sync_range_v = 20.0;
  double output_range_v = 5.0;
  int shots = 50;
  std::filesystem::path output = "dso-delay.json";
};

void add_dso_delay(CLI::App& command, CalibrateDsoDelayOptions& delay) {
  command.add_option("--oscilloscope", delay.oscilloscope, "HOST:PORT, or vxi11:HOST")->required();
  command.add_option("--family", delay.family,
                     "command family of the oscilloscope (default: by its identity)");
  command.add_option("--generator", delay.generator, "HOST:PORT (default: set by hand)");
  add_default(command, "--by", delay.by,
              "sync signal: rectangle (from edge to edge) or sine (from the trigger point; its "
              "noise is reported)",
              CLI::IsMember({"rectangle", "sine"}));
  add_default(command, "--frequency", delay.frequency_hz, "frequency of the generator in Hz");
  add_default(command, "--amplitude", delay.amplitude_v,
              "amplitude of the generator in V, zero to peak", CLI::PositiveNumber);
  add_default(command, "--sync-input", delay.sync_input,
              "input of the oscilloscope that sync is connected to; it triggers", CLI::Range(1, 8));
  add_default(command, "--output-input", delay.output_input,
              "input of the oscilloscope that its trigger output is connected to",
              CLI::Range(1, 8));
  add_default(command, "--sync-range", delay.sync_range_v, "range of that input in V peak to peak",
              CLI::PositiveNumber);
  add_default(command, "--output-range", delay.output_range_v,
              "range of that input in V peak to peak", CLI::PositiveNumber);
  add_default(command, "--shots", delay.shots, "shots to take", CLI::Range(3, 100000));
  add_default(command, "--output", delay.output, "file for the result as JSON");
}

using drivers::generator::ScpiGenerator;
using std::chrono::milliseconds;

constexpr milliseconds trigger_limit{3000};
constexpr milliseconds pause_after_failure{200};

struct Delays {
  analysis::TriggerDelay mean;
  std::string instrument;
  int failures = 0;
};

// A microsecond around the trigger for a rectangle; a whole period for a sine, with the deepest
// memory that is read in reasonable time.
drivers::dso::Acquisition acquisition_for(const CalibrateDsoDelayOptions& command,
                                          double frequency_hz) {
  if (command.by == "rectangle") {
    return {.before_trigger_s = 0.3e-6, .after_trigger_s = 0.7e-6, .points = 1000};
  }
  return {.before_trigger_s = 0.5 / frequency_hz,
          .after_trigger_s = 0.5 / frequency_hz,
          .points = 1'000'000};
}

// A generator whose output is on for as long as the object lives. The guard switches it off where
// this program is killed, or cannot do it itself.
class DrivenGenerator {
public:
  static Expected<DrivenGenerator> start(const CalibrateDsoDelayOptions& command,
                                         const std::stop_token& stop) {
    DYNCAL_TRY(auto guard, OutputGuard::start(command.generator));
    auto connected = ScpiGenerator::connect(command.generator);
    if (!connected) {
      guard.dismiss(); // nothing was switched on
      return fail(device_error(connected.error()));
    }
    DrivenGenerator driven(std::move(guard), std::move(*connected));
    ScpiGenerator& generator = *driven.generator_;
    generator.call_while_waiting(
        [stop](drivers::generator::Awaited) { return !stop.stop_requested(); });
    const auto set = generator.set_rectangle(command.by == "rectangle")
                         .and_then([&] { return generator.set_frequency(command.frequency_hz); })
                         .and_then([&] { return generator.set_amplitude_v(command.amplitude_v); })
                         .and_then([&] { return generator.set_output(true); });
    if (!set) {
      static_cast<void>(driven.switch_off()); // else the guard does
      return fail(device_error(set.error()));
    }
    return driven;
  }

  Expected<void> switch_off() {
    if (const auto off = generator_->set_output(false); !off) {
      return fail(ErrorCode::device,
                  fmt::format("THE OUTPUT OF THE GENERATOR MAY BE ON: switch it off by hand if you "
                              "can; a process goes on trying for ten minutes ({})",
                              off.error().message));
    }
    guard_.dismiss();
    return {};
  }

private:
  DrivenGenerator(OutputGuard guard, std::unique_ptr<ScpiGenerator> generator)
      : guard_(std::move(guard)), generator_(std::move(generator)) {}

  OutputGuard guard_;
  std::unique_ptr<ScpiGenerator> generator_;
};

Expected<Delays> measure(const CalibrateDsoDelayOptions& command,
                         const analysis::Frequency& frequency, const std::stop_token& stop) {
  drivers::StopSignal device_stop;
  const std::stop_callback raise(stop, [&] { device_stop.raise(); });
  drivers::dso::Oscilloscope oscilloscope(
      {.address = command.oscilloscope,
       .family = command.family,
       .inputs = {{"sync", command.sync_input, command.sync_range_v, 0.0},
                  {"output", command.output_input, command.output_range_v,
                   0.4 * command.output_range_v}}},
      device_stop);
  Delays delays;
  std::vector<analysis::ShotDelay> shots;
  double interval_s = 0.0;
  while (static_cast<int>(shots.size()) < command.shots) {
    const auto shot = oscilloscope.prepare(acquisition_for(command, frequency.hz())).and_then([&] {
      return oscilloscope.acquire(trigger_limit);
    });
    std::optional<std::string> problem;
    if (!shot) {
      problem = shot.error().message;
      if (shots.empty() && (shot.error().code == drivers::ErrorCode::refused ||
                            shot.error().code == drivers::ErrorCode::not_found)) {
        return fail(
            device_error(shot.error())); // a wrong address or instrument does not get better
      }
    } else {
      const analysis::DelayTrace trace{shot->first_sample_s, shot->interval_s,
                                       shot->traces[0].volts, shot->traces[1].volts};
      const auto delay = command.by == "rectangle" ? analysis::delay_by_rectangle(trace)
                                                   : analysis::delay_by_sine(trace, frequency);
      interval_s = shot->interval_s;
      if (delay) {
        shots.push_back(*delay);
      } else {
        problem = delay.error().message;
      }
    }
    if (stop.stop_requested()) {
      return fail(ErrorCode::interrupted,
                  fmt::format("interrupted after {} of {} shots", shots.size(), command.shots));
    }
    if (problem && ++delays.failures > command.shots) {
      return fail(ErrorCode::device,
                  fmt::format("too many shots fail, the last one: {}", *problem));
    }
    if (problem) {
      static_cast<void>(device_stop.wait_for(pause_after_failure));
    }
  }
  const auto mean = analysis::mean_trigger_delay(shots, interval_s);
  if (!mean) {
    return fail(ErrorCode::no_result, mean.error().message);
  }
  delays.mean = *mean;
  delays.instrument = oscilloscope.identity();
  return delays;
}

void print(const CalibrateDsoDelayOptions& command, const Delays& delays) {
  const analysis::TriggerDelay& delay = delays.mean;
  fmt::print("{}\nby {} at {} Hz, {} shots ({} failed)\n", one_line(delays.instrument), command.by,
             command.frequency_hz, delay.shots, delays.failures);
  fmt::print(
      "delay of the trigger output   {:10.3f} ns   u {:.3f} ns{}   scatter of one shot {:.3f} ns\n",
      1e9 * delay.delay_s, 1e9 * delay.of_delay.u, notable_k_text(delay.of_delay.k),
      1e9 * delay.scatter_s);
  if (command.by == "sine") {
    fmt::print("from the zero crossing        {:10.3f} ns   scatter of one shot {:.3f} ns (trigger "
               "noise included)\n",
               1e9 * delay.from_zero_crossing_s, 1e9 * delay.scatter_from_zero_crossing_s);
  }
  const std::size_t most =
      *std::max_element(delay.histogram.counts.begin(), delay.histogram.counts.end());
  for (std::size_t bin = 0; bin < delay.histogram.counts.size(); ++bin) {
    const double begin_s =
        delay.histogram.first_s + static_cast<double>(bin) * delay.histogram.width_s;
    fmt::print("{:10.3f} ns {:5} {}\n", 1e9 * begin_s, delay.histogram.counts[bin],
               std::string(40 * delay.histogram.counts[bin] / most, '#'));
  }
  fmt::print("for the bench file, under [corrections]:\ndso_delay = {{ file = \"{}\" }}\n",
             command.output.string());
}

Expected<void> write(const CalibrateDsoDelayOptions& command, const Delays& delays) {
  const analysis::TriggerDelay& delay = delays.mean;
  const nlohmann::ordered_json json = {
      {"instrument", delays.instrument},
      {"by", command.by},
      {"frequency_hz", command.frequency_hz},
      {"shots", delay.shots},
      {"failed_shots", delays.failures},
      {"value_s", delay.delay_s},
      {"u_s", delay.of_delay.u},
      {"k", delay.of_delay.k},
      {"nu_eff", json_number(delay.of_delay.degrees_of_freedom)},
      {"U_s", delay.of_delay.expanded()},
      {"scatter_s", delay.scatter_s},
      {"from_zero_crossing_s", delay.from_zero_crossing_s},
      {"scatter_from_zero_crossing_s", delay.scatter_from_zero_crossing_s},
      {"histogram",
       {{"first_s", delay.histogram.first_s},
        {"width_s", delay.histogram.width_s},
        {"counts", delay.histogram.counts}}}};
  return write_output_file(command.output, json_text(json, 1) + '\n');
}

Expected<void> run_calibrate_dso_delay(const CalibrateDsoDelayOptions& command,
                                       const std::stop_token& stop) {
  const auto frequency = analysis::Frequency::parse(command.frequency_hz);
  if (!frequency) {
    return fail(ErrorCode::bad_argument,
                fmt::format("--frequency {}: not a positive number in Hz", command.frequency_hz));
  }
  std::optional<DrivenGenerator> driven;
  if (!command.generator.empty()) {
    DYNCAL_TRY(auto started, DrivenGenerator::start(command, stop));
    driven.emplace(std::move(started));
  }
  const auto delays = measure(command, *frequency, stop);
  if (driven) {
    DYNCAL_TRY(driven->switch_off());
  }
  DYNCAL_TRY(delays);
  print(command, *delays);
  return write(command, *delays);
}

const Command calibrate_dso_delay_command{280, "calibrate dso-delay",
                                          "delay of an oscilloscope's trigger output",
                                          add_dso_delay, run_calibrate_dso_delay};

} // namespace
} // namespace dyncal::inline programs
