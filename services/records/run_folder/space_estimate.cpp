#include "services/records/run_folder/space_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <system_error>

#include <fmt/core.h>

namespace dyncal::inline records {
namespace {

constexpr double unknown_rate_hz = 10'000.0;
constexpr double value_bytes = 8.0;
constexpr double stamp_bytes = 13.0;
constexpr double between_steps_s = 2.0;
constexpr double surplus = 1.2;
constexpr std::uint64_t shot_bytes = 1'000'000;
constexpr std::uint64_t result_bytes = 16'000; // of a step and channel
constexpr std::uint64_t figures_bytes = 16'000'000;

double planned_seconds(const Recipe& recipe) {
  double seconds = 0.0;
  for (const RecipeStep& step : recipe.steps) {
    seconds += step.settling_s + step.duration_s + between_steps_s;
  }
  return seconds / static_cast<double>(recipe.lines_at_once());
}

double sampled_bytes(const RunSource& source, double seconds,
                     const std::map<std::string, double>& rates_hz) {
  double rate_hz = source.description.nominal_rate_hz;
  if (const auto measured = rates_hz.find(source.source);
      !(rate_hz > 0.0) && measured != rates_hz.end()) {
    rate_hz = measured->second;
  }
  if (!(rate_hz > 0.0)) {
    rate_hz = unknown_rate_hz;
  }
  const auto channels = static_cast<double>(source.description.channels.size());
  return rate_hz * (channels * value_bytes + stamp_bytes) * seconds;
}

double source_bytes(const RunSource& source, const Recipe& recipe, const BenchFile& bench,
                    const std::map<std::string, double>& rates_hz) {
  const SourceSettings* settings = bench.source(source.source);
  if (settings != nullptr && settings->is<FileSourceSettings>()) {
    std::error_code unknown;
    const auto size = std::filesystem::file_size(settings->as<FileSourceSettings>()->path, unknown);
    return unknown ? 0.0 : static_cast<double>(size);
  }
  if (is_triggered(source.kind)) {
    const std::uint64_t shots = std::max<std::uint32_t>(recipe.series.shots, 1);
    return static_cast<double>(shots * recipe.steps.size() * shot_bytes);
  }
  return sampled_bytes(source, planned_seconds(recipe), rates_hz);
}

} // namespace

SpaceEstimate estimate_space(const RunOutcome& planned, const BenchFile& bench,
                             const std::map<std::string, double>& rates_hz, bool recorded) {
  SpaceEstimate estimate;
  if (!planned.recipe) {
    return estimate;
  }
  const Recipe& recipe = *planned.recipe;
  double recording = 0.0;
  std::uint64_t channels = recipe.dut().size();
  for (const RunSource& source : planned.sources) {
    recording += surplus * source_bytes(source, recipe, bench, rates_hz);
    channels = std::max<std::uint64_t>(channels, source.description.channels.size());
  }
  estimate.recording_bytes = recorded ? static_cast<std::uint64_t>(std::ceil(recording)) : 0;
  estimate.results_bytes = 2 * result_bytes * recipe.steps.size() * channels + figures_bytes;
  return estimate;
}

std::string size_text(std::uint64_t bytes) {
  const auto size = static_cast<double>(bytes);
  if (size >= 1e9) {
    return fmt::format("{:.1f} GB", size * 1e-9);
  }
  return size >= 1e6 ? fmt::format("{:.1f} MB", size * 1e-6)
                     : fmt::format("{:.0f} kB", size * 1e-3);
}

} // namespace dyncal::inline records
