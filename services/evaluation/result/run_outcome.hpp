// What a run leaves behind, whether it was evaluated here or collected from the bus. Plain data;
// any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/sample_block.hpp"
#include "services/contract/evaluation_method.hpp"
#include "services/contract/source_kind.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/clock_report.hpp"
#include "services/evaluation/result/run_pause.hpp"
#include "services/evaluation/result/step_result.hpp"
#include "services/evaluation/result/transfer_function.hpp"

namespace dyncal::inline evaluation {

// A source of the run as it described itself.
struct RunSource {
  std::string source;
  SourceKind kind = SourceKind::acs;
  std::string software; // of the service that published it
  drivers::SourceDescription description;
};

// The file that the sync ADC was corrected by.
struct AdcFile {
  std::string path;
  std::string channel; // its input and path, as the file names them
  std::string sha256;
};

struct RunOutcome {
  std::string bench;
  std::string run;
  EvaluationMethod method = EvaluationMethod::sample_timestamping;
  std::string recipe_sha256;
  std::size_t planned_steps = 0;
  std::optional<Recipe> recipe;    // what was planned
  std::optional<AdcFile> adc_file; // nothing: not corrected
  std::int64_t began_utc_ns = 0;   // 0: not known
  std::int64_t ended_utc_ns = 0;   // 0: not known
  std::vector<RunSource> sources;  // those of the recipe
  std::string analysis_dds;        // DDS implementation of the analysis service; "none" offline
  std::string analysis_software;   // its name and version; empty: not known
  std::string analysis_host;       // its computer; empty offline
  std::vector<StepResult> results; // in the order of steps, then as they came
  std::vector<TransferFunction> transfer_functions;
  std::vector<ClockReport> clock_reports;
  std::vector<RunPause> pauses;
  bool interrupted = false;
  bool output_may_be_on = false;  // nobody has confirmed that the generator's output is off
  bool output_is_guarded = false; // and a guard goes on trying to switch it off
  std::string problem;            // why the run ended early; empty when it did not
};

// What Measurement::message says of a run that the user ended.
inline constexpr const char* interrupted_by_user = "interrupted by the user";

// Puts everything that comes in any order into one: results by step, repetition and channel, the
// rest by channel or source, sources as the recipe has them.
void sort_outcome(RunOutcome& outcome);

// Of a run that has no results yet.
[[nodiscard]] RunOutcome outcome_of(const Recipe& recipe);

} // namespace dyncal::inline evaluation
