#include "services/programs/command/analyse_recording.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "services/programs/command/run_command.hpp"
#include "services/records/exchange/opened_recording.hpp"
#include "services/records/replay/recorded_run.hpp"
#include "services/run/run_plan.hpp"

namespace dyncal::inline programs {
namespace {

struct OtherRecipe {
  Recipe recipe;
  std::optional<AdcFile> adc_file;
};

Expected<OtherRecipe> read_recipe(const std::filesystem::path& file) {
  DYNCAL_TRY(const auto bench, read_bench_file(file));
  DYNCAL_TRY(const auto adc, read_adc_calibration(bench));
  return plan_recipe(bench, "recorded", adc).map([&](Recipe recipe) {
    return OtherRecipe{std::move(recipe), adc_file_of(bench)};
  });
}

} // namespace

Expected<RunOutcome> analyse_recording(const AnalyseCommand& command, const std::stop_token& stop,
                                       const SharedWorkCount& count) {
  RecordedRunOptions wish{.run = command.run, .recipe = {}, .count = count};
  std::optional<AdcFile> adc_file;
  if (command.recipe) {
    DYNCAL_TRY(auto other, read_recipe(*command.recipe));
    wish.recipe = std::move(other.recipe);
    adc_file = std::move(other.adc_file);
  }
  DYNCAL_TRY(auto opened, open_recording(command.bench_file, count, stop));
  for (const std::string& warning : opened.warnings) {
    spdlog::warn("{}", warning);
  }
  DYNCAL_TRY(auto evaluated, evaluate_recording(opened.reader, wish, stop));
  for (const std::string& warning : evaluated.warnings) {
    spdlog::warn("{}", warning);
  }
  if (command.recipe) {
    evaluated.outcome.adc_file = std::move(adc_file);
  }
  return std::move(evaluated.outcome);
}

} // namespace dyncal::inline programs
