#include "services/command/run_command.hpp"

#include <array>
#include <ctime>
#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "drivers/utc_clock.hpp"
#include "services/bench/adc_file.hpp"
#include "services/command/progress_line.hpp"
#include "services/contract/digest.hpp"
#include "services/program/bench_program.hpp"
#include "services/report/show_outcome.hpp"
#include "services/run/bench_queue.hpp"

namespace dyncal::services {

std::string run_from_time() {
  const std::int64_t now_ms = utc_now_ns() / 1'000'000;
  const auto seconds = static_cast<std::time_t>(now_ms / 1000);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%S", &utc);
  return fmt::format("{}.{:03}Z", std::string(text.data(), length), now_ms % 1000);
}

Expected<std::vector<analysis::AdcCalibrationPoint>> read_adc_calibration(const BenchFile& bench) {
  if (!bench.corrections.adc) {
    return std::vector<analysis::AdcCalibrationPoint>{};
  }
  return read_adc_file(*bench.corrections.adc);
}

std::optional<AdcFile> adc_file_of(const BenchFile& bench) {
  if (!bench.corrections.adc) {
    return std::nullopt;
  }
  std::ifstream file(bench.corrections.adc->file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return AdcFile{bench.corrections.adc->file.string(), bench.corrections.adc->channel,
                 sha256_hex(text)};
}

namespace {

// A run that was refused is known by its name: the next attempt needs another.
std::string name_of_run(const RunCommand& command, int turn) {
  if (command.run.empty()) {
    return run_from_time();
  }
  return turn == 1 ? command.run : fmt::format("{}-{}", command.run, turn);
}

// Waits for the end of other runs; again when one of several that waited was quicker.
Expected<RunOutcome> conduct_in_turn(const RunCommand& command, const BenchFile& bench,
                                     const std::vector<analysis::AdcCalibrationPoint>& adc,
                                     bus::Participant& participant, const ShowProgress& show,
                                     const std::stop_token& stop) {
  auto queue = BenchQueue::open(participant, bus::system_clock(), bench.bench);
  if (!queue) {
    return fail(queue.error());
  }
  std::string shown;
  const auto show_phase = [&](const std::string& phase) {
    if (phase != std::exchange(shown, phase)) {
      RunProgress progress;
      progress.notice = phase;
      show(progress);
    }
  };
  for (int turn = 1;; ++turn) {
    if (const auto free = queue->wait_until_free(show_phase, stop); !free) {
      return fail(free.error());
    }
    auto outcome =
        RunController(participant, bench, name_of_run(command, turn), show).conduct(adc, stop);
    const bool refused = !outcome && outcome.error().code == ErrorCode::no_source;
    if (!refused || stop.stop_requested() || !queue->taken_by()) {
      return outcome;
    }
  }
}

// Nobody else may conduct it: a run that lives is heard within a few seconds.
Expected<RunOutcome> resume_run(const RunCommand& command, const BenchFile& bench,
                                const std::vector<analysis::AdcCalibrationPoint>& adc,
                                bus::Participant& participant, const ShowProgress& show,
                                const std::stop_token& stop) {
  auto queue = BenchQueue::open(participant, bus::system_clock(), bench.bench);
  if (!queue) {
    return fail(queue.error());
  }
  if (const auto other = queue->listen(stop)) {
    return fail(ErrorCode::no_source,
                fmt::format("bench '{}' is in use by {}; wait for its end, or end it there",
                            bench.bench, *other));
  }
  return RunController(participant, bench, command.resume, show).resume(adc, stop);
}

Expected<RunOutcome> conduct_as_told(const RunCommand& command, const BenchFile& bench,
                                     const std::vector<analysis::AdcCalibrationPoint>& adc,
                                     bus::Participant& participant, const ShowProgress& show,
                                     const std::stop_token& stop) {
  if (!command.resume.empty()) {
    return resume_run(command, bench, adc, participant, show, stop);
  }
  if (command.wait) {
    return conduct_in_turn(command, bench, adc, participant, show, stop);
  }
  return RunController(participant, bench, name_of_run(command, 1), show).conduct(adc, stop);
}

} // namespace

Expected<RunOutcome> conduct_run(const RunCommand& command, const std::stop_token& stop) {
  const auto bench = read_bench_file(command.bench_file);
  if (!bench) {
    return fail(bench.error());
  }
  const auto adc = read_adc_calibration(*bench);
  if (!adc) {
    return fail(adc.error());
  }
  if (const auto possible = check_outputs(command.json, command.figures); !possible) {
    return fail(possible.error());
  }
  const std::optional<AdcFile> adc_file = adc_file_of(*bench);
  NetworkOptions network = command.network;
  add_network_settings(bench->network, network);
  auto participant = join_network(network, "dyncal-run");
  if (!participant) {
    return fail(participant.error());
  }
  ProgressLine progress(stderr);
  const ShowProgress show = [&](const RunProgress& state) { progress.show(state); };
  auto outcome = conduct_as_told(command, *bench, *adc, *participant, show, stop);
  progress.end();
  if (!outcome) {
    return outcome;
  }
  outcome->adc_file = adc_file;
  if (const auto shown = show_outcome(*outcome, command.json, command.figures); !shown) {
    Error error = shown.error();
    if (outcome->output_may_be_on) {
      error.message += "; " + output_warning();
    }
    return fail(std::move(error));
  }
  return outcome;
}

int conclude(const RunOutcome& outcome) {
  const auto complete = check_complete(outcome);
  return complete ? 0 : report_error(complete.error());
}

} // namespace dyncal::services
