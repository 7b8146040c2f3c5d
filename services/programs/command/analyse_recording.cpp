#include "services/programs/command/analyse_recording.hpp"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "services/programs/command/run_command.hpp"
#include "services/records/exchange/opened_recording.hpp"
#include "services/records/replay/recorded_run.hpp"
#include "services/run/run_plan.hpp"

namespace dyncal::services {
namespace {

struct OtherRecipe {
  Recipe recipe;
  std::optional<AdcFile> adc_file;
};

Expected<OtherRecipe> read_recipe(const std::filesystem::path& file) {
  const auto bench = read_bench_file(file);
  if (!bench) {
    return fail(bench.error());
  }
  const auto adc = read_adc_calibration(*bench);
  if (!adc) {
    return fail(adc.error());
  }
  return plan_recipe(*bench, "recorded", *adc).map([&](Recipe recipe) {
    return OtherRecipe{std::move(recipe), adc_file_of(*bench)};
  });
}

} // namespace

Expected<RunOutcome> analyse_recording(const AnalyseCommand& command, const std::stop_token& stop,
                                       const SharedWorkCount& count) {
  RecordedRunOptions wish{.run = command.run, .recipe = {}, .count = count};
  std::optional<AdcFile> adc_file;
  if (command.recipe) {
    auto other = read_recipe(*command.recipe);
    if (!other) {
      return fail(other.error());
    }
    wish.recipe = std::move(other->recipe);
    adc_file = std::move(other->adc_file);
  }
  auto opened = open_recording(command.bench_file, count, stop);
  if (!opened) {
    return fail(opened.error());
  }
  for (const std::string& warning : opened->warnings) {
    spdlog::warn("{}", warning);
  }
  auto evaluated = evaluate_recording(opened->reader, wish, stop);
  if (!evaluated) {
    return fail(evaluated.error());
  }
  for (const std::string& warning : evaluated->warnings) {
    spdlog::warn("{}", warning);
  }
  if (command.recipe) {
    evaluated->outcome.adc_file = std::move(adc_file);
  }
  return std::move(evaluated->outcome);
}

} // namespace dyncal::services
