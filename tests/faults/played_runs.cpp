// The messages of runs, without a bench: for what shows or keeps them for longer than real runs
// could be conducted in a test.
//
//   played_runs DOMAIN VENDOR
//
// For each line "NAME" on standard input: a run of that name of bench 'played', as a conductor and
// an analysis send it (36 steps, with fits and budgets), from its plan to its end; then the line
// "NAME" on standard output. Keeps the writers of the newest two runs, as an analysis does.
#include <cstdio>
#include <deque>
#include <iostream>
#include <memory>
#include <string>

#include "services/bus/bus.hpp"
#include "services/contract/topics.hpp"
#include "services/evaluation/result/result_messages.hpp"
#include "tests/unit/services/network/messages.hpp"
#include "tests/unit/services/views/report/example_outcome.hpp"

namespace {

using namespace dyncal;

constexpr const char* bench = "played";
constexpr std::uint32_t steps = 36;
constexpr std::size_t budget_rows = 14; // as a run with stamped samples has
constexpr std::size_t kept_runs = 2;

struct Run {
  bus::Writer<wire::Measurement> measurement;
  bus::Writer<wire::Excitation> excitation;
  bus::Writer<wire::CalibrationResult> result;
  bus::Writer<wire::TransferFunction> function;
};

std::string frequency_of(std::uint32_t step) {
  return std::to_string(10 * step);
}

wire::Measurement measurement_of(const std::string& run, wire::MeasurementState state) {
  wire::Measurement measurement = network::measurement_of(bench, run, state);
  measurement.steps().resize(steps, measurement.steps().front());
  for (std::uint32_t step = 1; step <= steps; ++step) {
    measurement.steps()[step - 1].step(step);
    measurement.steps()[step - 1].frequency_text_hz(frequency_of(step));
  }
  return measurement;
}

Run play(bus::Participant& participant, const std::string& name) {
  Run run{participant.writer(bus::topics::measurement, bench).value(),
          participant.writer(bus::topics::excitation, bench).value(),
          participant.writer(bus::topics::calibration_result, bench).value(),
          participant.writer(bus::topics::transfer_function, bench).value()};
  evaluation::Recipe recipe = tests::example_recipe();
  recipe.bench = bench;
  recipe.run = name;
  run.measurement.write(measurement_of(name, wire::MEASUREMENT_RUNNING));
  evaluation::TransferFunction function = tests::example_function("dau/acceleration_z", 1.0);
  function.points.resize(steps, function.points.front());
  evaluation::StepResult result = tests::example_outcome().results.front();
  result.budget.resize(budget_rows, result.budget.back());
  for (std::uint32_t step = 1; step <= steps; ++step) {
    wire::Excitation excitation = network::excitation_of(bench, name, step, wire::EXCITATION_DONE);
    excitation.frequency_text_hz(frequency_of(step));
    run.excitation.write(excitation);
    result.step = step;
    result.frequency_text_hz = frequency_of(step);
    result.frequency_hz = 10.0 * step;
    run.result.write(to_message(recipe, result));
    function.points[step - 1].frequency_text_hz = result.frequency_text_hz;
    function.points[step - 1].frequency_hz = result.frequency_hz;
  }
  function.group_delay->phase_covariance.assign(std::size_t{steps} * steps, 1e-6);
  run.function.write(to_message(recipe, function));
  run.measurement.write(measurement_of(name, wire::MEASUREMENT_DONE));
  return run;
}

} // namespace

int main(int argc, char** argv) {
  bus::ParticipantOptions options;
  options.name = "played-runs";
  options.domain = argc > 1 ? std::atoi(argv[1]) : 0;
  options.vendor = bus::parse_vendor(argc > 2 ? argv[2] : "cyclonedds").value();
  bus::Participant participant = bus::Participant::create(options).value();
  std::deque<Run> runs;
  for (std::string name; std::getline(std::cin, name);) {
    runs.push_back(play(participant, name));
    if (runs.size() > kept_runs) {
      runs.pop_front();
    }
    std::printf("%s\n", name.c_str());
    std::fflush(stdout);
  }
  return 0;
}
