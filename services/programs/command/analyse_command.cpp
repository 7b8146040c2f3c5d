// `dyncal analyse BENCH.toml`: the same evaluation as a live run, from the bench file's file
// sources, without the network. Shots of series time stamping come from folders (shot_files.hpp).
// `dyncal analyse RECORDING`: the results of the live run from its recording, or by another bench
// file.
//
// Files are read in threads of their own, a bounded stretch ahead; the evaluation runs in the
// caller's thread. All have ended when it returns. Fails like `dyncal run`: a file with an error is
// named with its line, a source that is neither a file nor a CAN log is refused.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <thread>
#include <tuple>

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "services/base/version.hpp"
#include "services/bench/file/adc_file.hpp"
#include "services/evaluation/run_evaluator.hpp"
#include "services/evaluation/step_survey.hpp"
#include "services/instruments/played_source.hpp"
#include "services/instruments/reference_steps.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/figure_options.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/exchange/opened_recording.hpp"
#include "services/records/replay/file_input.hpp"
#include "services/records/replay/recorded_run.hpp"
#include "services/records/replay/sample_memory.hpp"
#include "services/records/replay/shot_files.hpp"
#include "services/run/run_plan.hpp"
#include "services/views/report/run_figures.hpp"
#include "services/views/report/show_outcome.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline programs {
namespace {

struct AnalyseOptions {
  std::filesystem::path bench_file; // or a run folder (services/records/run_folder), or a recording
  std::string run;                  // of the recording; empty: the only one
  std::optional<std::filesystem::path> recipe; // bench file to evaluate the recording by
  std::optional<std::filesystem::path> output; // the result as JSON
  FigureFiles figures;
};

void add_analyse(CLI::App& command, AnalyseOptions& analyse) {
  take_run(command.add_option("BENCH.toml", analyse.bench_file,
                              "bench file, the folder of a run, or a recording (.mcap), which "
                              "gives the results of the live run"))
      ->required();
  command.add_option("--run", analyse.run, "run of the recording (default: the only one)");
  command.add_option("--recipe", analyse.recipe,
                     "evaluate the recording by this bench file, not by the one of its run");
  command.add_option("--output", analyse.output, "write the result to this file as JSON");
  add_figure_options(command, analyse.figures);
}

// At once, one a processor: a step takes longer than reading the next; each holds its samples.
constexpr std::size_t max_evaluations = 4;

using Inputs = std::vector<std::unique_ptr<FileInput>>;

SourceKind kind_of(const BenchFile& bench, const std::string& name) {
  const SourceSettings& source = *bench.source(name);
  if (source.is<OscilloscopeSourceSettings>()) {
    return SourceKind::dso;
  }
  return source.is<SeriesSourceSettings>() ? SourceKind::tss : kind_of(bench.method, name);
}

void add_source(const BenchFile& bench, const std::string& name,
                const drivers::SourceDescription& description, RunOutcome& outcome) {
  outcome.sources.push_back({name, kind_of(bench, name), software_version(), description});
}

// All at once: a record of shots is small beside one of samples.
Expected<void> take_shots(const BenchFile& bench, const std::string& source,
                          RunEvaluator& evaluator, RunOutcome& outcome) {
  DYNCAL_TRY(auto files, read_shot_files(bench, source));
  add_source(bench, source, files.description, outcome);
  DYNCAL_TRY(evaluator.describe(source, std::move(files.description)));
  for (TriggeredRecord& record : files.records) {
    evaluator.add(source, std::move(record));
  }
  return {};
}

// The reference of a system that has evaluated itself.
Expected<void> take_table(const BenchFile& bench, RunEvaluator& evaluator, RunOutcome& outcome) {
  const std::string& name = evaluator.recipe().reference_table;
  if (name.empty()) {
    return {};
  }
  std::vector<PlannedReferenceStep> plan;
  for (const RecipeStep& step : evaluator.recipe().steps) {
    plan.push_back(
        {step.step, step.repetition, step.frequency_text_hz, step.settling_s + step.duration_s});
  }
  const SourceSettings& source = *bench.source(name);
  DYNCAL_TRY(auto steps, read_reference_steps(source, plan));
  add_source(bench, name, describe_table(source), outcome);
  for (ReferenceStep& step : steps) {
    evaluator.add(name, std::move(step));
  }
  return {};
}

Expected<Inputs> open_inputs(const BenchFile& bench, RunEvaluator& evaluator, RunOutcome& outcome) {
  Inputs inputs;
  DYNCAL_TRY(take_table(bench, evaluator, outcome));
  for (const std::string& name : evaluator.recipe().sources()) {
    const SourceSettings& source = *bench.source(name);
    if (source.is<OscilloscopeSourceSettings>() || source.is<SeriesSourceSettings>()) {
      DYNCAL_TRY(take_shots(bench, name, evaluator, outcome));
      continue;
    }
    DYNCAL_TRY(auto input, FileInput::open(source));
    add_source(bench, name, input->description(), outcome);
    DYNCAL_TRY(evaluator.describe(name, input->description()));
    inputs.push_back(std::move(input));
  }
  return inputs;
}

void collect(EvaluationOutput output, RunOutcome& outcome) {
  const auto append = [](auto& from, auto& to) { std::ranges::move(from, std::back_inserter(to)); };
  append(output.results, outcome.results);
  for (StepResult& settled : output.settled) {
    *std::find_if(outcome.results.begin(), outcome.results.end(), [&](const StepResult& one) {
      return one.channel == settled.channel && one.step == settled.step &&
             one.repetition == settled.repetition;
    }) = std::move(settled);
  }
  append(output.transfer_functions, outcome.transfer_functions);
  append(output.clock_reports, outcome.clock_reports);
}

// An interferometer has found a better ellipse.
void describe_anew(const std::string& source, const drivers::SourceDescription& description,
                   RunEvaluator& evaluator, RunOutcome& outcome) {
  std::ranges::find(outcome.sources, source, &RunSource::source)->description = description;
  evaluator.describe_signals(source, description.quadrature_signals);
}

// Takes from the file that is behind in its own time, so that no record has to wait long for the
// other.
Expected<void> evaluate(Inputs inputs, RunEvaluator& evaluator, const std::stop_token& stop,
                        RunOutcome& outcome) {
  while (!evaluator.finished() && !inputs.empty() && !stop.stop_requested()) {
    const auto behind =
        std::min_element(inputs.begin(), inputs.end(), [](const auto& a, const auto& b) {
          return a->reached_ns() < b->reached_ns();
        });
    DYNCAL_TRY(const auto block, (*behind)->next());
    if (block.description) {
      describe_anew((*behind)->source(), *block.description, evaluator, outcome);
    }
    evaluator.add((*behind)->source(), (*behind)->view(block));
    collect(evaluator.take_output(), outcome);
    if (block.end_of_stream) {
      inputs.erase(behind);
    }
    if (const auto source = evaluator.source_of_clock_alone()) {
      std::erase_if(inputs, [&](const auto& input) { return input->source() != *source; });
    }
  }
  outcome.interrupted = stop.stop_requested();
  if (!evaluator.finished()) {
    evaluator.end_of_excitation(outcome.interrupted);
    evaluator.finish_now();
    collect(evaluator.take_output(), outcome);
  }
  return {};
}

// Stamps before 2000 were not made by a clock that knows the time: the record begins at 0.
constexpr std::int64_t min_utc_ns = 946'684'800'000'000'000;

// The time of the run is that of its records, where a source has stamps in UTC.
void add_recorded_time(RunOutcome& outcome) {
  const auto has_utc_stamps = [&](const std::string& name) {
    return std::any_of(outcome.sources.begin(), outcome.sources.end(), [&](const RunSource& one) {
      return one.source == name && one.description.time_base == drivers::TimeBase::utc &&
             !is_triggered(one.kind);
    });
  };
  for (const StepResult& result : outcome.results) {
    for (const SourceSamples& samples : result.samples) {
      if (samples.used == 0 || samples.first_stamp_ns < min_utc_ns ||
          !has_utc_stamps(samples.source)) {
        continue;
      }
      const bool first = outcome.ended_utc_ns == 0;
      outcome.began_utc_ns =
          first ? samples.first_stamp_ns : std::min(outcome.began_utc_ns, samples.first_stamp_ns);
      outcome.ended_utc_ns = std::max(outcome.ended_utc_ns, samples.last_stamp_ns);
    }
  }
}

// A run folder stands for the bench file in it, with its copies of the files.
Expected<BenchFile> read_bench_or_folder(const std::filesystem::path& path) {
  return std::filesystem::is_directory(path)
             ? read_bench_file(path / copied_bench_file, NamedFiles::Place::copies)
             : read_bench_file(path);
}

// Reads them once more, for all that they show of any step.
Expected<std::shared_ptr<const RunSchedule>>
look_at_all(const BenchFile& bench, const Recipe& recipe, const std::stop_token& stop) {
  StepSurvey survey(recipe);
  for (const std::string& name : recipe.sources()) {
    if (!survey.looks_at(name)) {
      continue;
    }
    DYNCAL_TRY(auto input, FileInput::open(*bench.source(name)));
    survey.describe(name, input->description());
    for (bool ended = false; !ended && !stop.stop_requested();) {
      DYNCAL_TRY(const auto block, input->next());
      survey.add(name, input->view(block));
      ended = block.end_of_stream;
    }
  }
  return survey.schedule();
}

struct Evaluated {
  RunOutcome outcome;
  bool needs_survey = false;
};

Expected<Evaluated> evaluate_files(const BenchFile& bench, const Recipe& recipe,
                                   const EvaluationLimits& limits, const std::stop_token& stop) {
  Evaluated evaluated{.outcome = outcome_of(recipe)};
  evaluated.outcome.adc_file = adc_file_of(bench);
  RunEvaluator evaluator(recipe, limits);
  DYNCAL_TRY(auto inputs, open_inputs(bench, evaluator, evaluated.outcome));
  DYNCAL_TRY(evaluate(std::move(inputs), evaluator, stop, evaluated.outcome));
  evaluated.needs_survey = !evaluated.outcome.interrupted && evaluator.needs_survey();
  return evaluated;
}

// What a source said of itself is in the recording, and no recipe changes it.
std::vector<std::string> ignored_identities(const BenchFile& bench, const RunOutcome& outcome) {
  std::vector<std::string> sentences;
  for (const SourceSettings& source : bench.sources) {
    const auto recorded = std::ranges::find(outcome.sources, source.name, &RunSource::source);
    if (recorded == outcome.sources.end()) {
      continue;
    }
    const drivers::SourceDescription& description = recorded->description;
    for (const auto& [key, stated, known] :
         {std::tuple{"serial", source.identity.serial, description.serial},
          std::tuple{"model", source.identity.device, description.device}}) {
      if (!stated.empty() && stated != known) {
        sentences.push_back(fmt::format(
            "{}: the recipe says {} '{}' of source {}, the run was recorded with '{}', and the "
            "result keeps that; correct it with 'dyncal amend RUN {}/{}={} --reason TEXT'",
            bench.path.string(), key, stated, source.name, known, source.name, key, stated));
      }
    }
  }
  return sentences;
}

// Prints what is damaged or missing on standard error.
Expected<RunOutcome> analyse_recording(const AnalyseOptions& command, const std::stop_token& stop,
                                       const SharedWorkCount& count) {
  const auto warn = [](const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings) {
      spdlog::warn("{}", warning);
    }
  };
  RecordedRunOptions wish{.run = command.run, .recipe = {}, .count = count};
  std::optional<AdcFile> adc_file;
  std::optional<BenchFile> recipe;
  if (command.recipe) {
    DYNCAL_TRY(const auto bench, read_bench_file(*command.recipe));
    DYNCAL_TRY(const auto adc, read_adc_calibration(bench));
    DYNCAL_TRY(wish.recipe, plan_recipe(bench, "recorded", adc));
    if (wish.recipe->is_multisine()) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("{}: a multi-sine is evaluated from file sources, not from a "
                              "recording",
                              bench.path.string()));
    }
    adc_file = adc_file_of(bench);
    recipe = bench;
  }
  DYNCAL_TRY(auto opened, open_recording(command.bench_file, count, stop));
  warn(opened.warnings);
  DYNCAL_TRY(auto evaluated, evaluate_recording(opened.reader, wish, stop));
  warn(evaluated.warnings);
  if (recipe) {
    evaluated.outcome.adc_file = std::move(adc_file);
    warn(ignored_identities(*recipe, evaluated.outcome));
  }
  return std::move(evaluated.outcome);
}

Expected<RunOutcome> analyse(const AnalyseOptions& command, const std::stop_token& stop) {
  const WorkProgress progress("reading");
  if (is_recording(command.bench_file)) {
    return analyse_recording(command, stop, progress.count());
  }
  const auto suffix = command.bench_file.extension();
  if (suffix == ".h5" || suffix == ".hdf5") {
    return fail(
        ErrorCode::bad_argument,
        fmt::format("{}: an HDF5 file is not evaluated as a run: give the recording (.mcap) "
                    "that it was exported from, or name it as the file of a source in a "
                    "bench file",
                    command.bench_file.string()));
  }
  if (command.recipe || !command.run.empty()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("{}: --run and --recipe are for recordings (.mcap)",
                            command.bench_file.string()));
  }
  DYNCAL_TRY(const auto bench, read_bench_or_folder(command.bench_file));
  DYNCAL_TRY(const auto adc, read_adc_calibration(bench));
  DYNCAL_TRY(const auto recipe, plan_recipe(bench, "files", adc));
  EvaluationLimits limits{.evaluations_at_once = std::clamp<std::size_t>(
                              std::thread::hardware_concurrency(), 1, max_evaluations),
                          .clock_to_the_end = true,
                          .count = progress.count()};
  auto evaluated = evaluate_files(bench, recipe, limits, stop);
  if (evaluated && evaluated->needs_survey) {
    DYNCAL_TRY(limits.schedule, look_at_all(bench, recipe, stop));
    evaluated = evaluate_files(bench, recipe, limits, stop);
  }
  DYNCAL_TRY(evaluated);
  RunOutcome outcome = std::move(evaluated->outcome);
  outcome.analysis_dds = "none";
  outcome.analysis_software = software_version();
  add_recorded_time(outcome);
  return outcome;
}

// Who conducted the run has stated it in its folder.
RunStatements statements_of(const std::filesystem::path& run) {
  std::error_code unknown;
  if (!std::filesystem::is_directory(run, unknown)) {
    return {};
  }
  const auto result = read_result(run);
  return result ? static_cast<const RunStatements&>(*result) : RunStatements{};
}

Expected<void> run_analyse(const AnalyseOptions& command, const std::stop_token& stop) {
  DYNCAL_TRY(check_outputs(command.output, command.figures));
  keep_memory_for_samples();
  DYNCAL_TRY(const auto outcome, analyse(command, stop));
  DYNCAL_TRY(
      show_outcome(outcome, command.output, command.figures, statements_of(command.bench_file)));
  return check_complete(outcome);
}

const Command analyse_command{
    110, "analyse",
    "evaluate the file sources of a bench file, or a recording, without the network", add_analyse,
    run_analyse};

} // namespace
} // namespace dyncal::inline programs
