#include "services/programs/command/calibrate_dso_delay_command.hpp"

#include <algorithm>
#include <chrono>
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
#include "services/daemon/program/program.hpp"
#include "services/run/output_guard.hpp"

namespace dyncal::inline programs {
namespace {

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
drivers::dso::Acquisition acquisition_for(const CalibrateDsoDelayCommand& command,
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
  static Expected<DrivenGenerator> start(const CalibrateDsoDelayCommand& command,
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

Expected<Delays> measure(const CalibrateDsoDelayCommand& command,
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

void print(const CalibrateDsoDelayCommand& command, const Delays& delays) {
  const analysis::TriggerDelay& delay = delays.mean;
  fmt::print("{}\nby {} at {} Hz, {} shots ({} failed)\n", one_line(delays.instrument), command.by,
             command.frequency_hz, delay.shots, delays.failures);
  fmt::print(
      "delay of the trigger output   {:10.3f} ns   u {:.3f} ns   scatter of one shot {:.3f} ns\n",
      1e9 * delay.delay_s, 1e9 * delay.u_delay_s, 1e9 * delay.scatter_s);
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

Expected<void> write(const CalibrateDsoDelayCommand& command, const Delays& delays) {
  const analysis::TriggerDelay& delay = delays.mean;
  const nlohmann::ordered_json json = {
      {"instrument", delays.instrument},
      {"by", command.by},
      {"frequency_hz", command.frequency_hz},
      {"shots", delay.shots},
      {"failed_shots", delays.failures},
      {"value_s", delay.delay_s},
      {"u_s", delay.u_delay_s},
      {"scatter_s", delay.scatter_s},
      {"from_zero_crossing_s", delay.from_zero_crossing_s},
      {"scatter_from_zero_crossing_s", delay.scatter_from_zero_crossing_s},
      {"histogram",
       {{"first_s", delay.histogram.first_s},
        {"width_s", delay.histogram.width_s},
        {"counts", delay.histogram.counts}}}};
  return write_output_file(command.output, json_text(json, 1) + '\n');
}

} // namespace

int run_calibrate_dso_delay(const CalibrateDsoDelayCommand& command, const std::stop_token& stop) {
  const auto frequency = analysis::Frequency::parse(command.frequency_hz);
  if (!frequency) {
    return report_error(
        {ErrorCode::bad_argument,
         fmt::format("--frequency {}: not a positive number in Hz", command.frequency_hz)});
  }
  std::optional<DrivenGenerator> driven;
  if (!command.generator.empty()) {
    auto started = DrivenGenerator::start(command, stop);
    if (!started) {
      return report_error(started.error());
    }
    driven.emplace(std::move(*started));
  }
  const auto delays = measure(command, *frequency, stop);
  if (driven) {
    if (const auto off = driven->switch_off(); !off) {
      return report_error(off.error());
    }
  }
  if (!delays) {
    return report_error(delays.error());
  }
  print(command, *delays);
  const auto written = write(command, *delays);
  return written ? 0 : report_error(written.error());
}

} // namespace dyncal::inline programs
