#include "tests/unit/services/evaluation/closures/drawn_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "services/evaluation/transfer_summary.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double level_m_s2 = 10.0;
constexpr double rate_hz = 1000.0;

struct Drawn {
  double delay_s, magnitude, noise, clock_rel, mounting_rel, mounting_s;
};

Drawn draw(std::mt19937& random) {
  std::uniform_real_distribution<double> part(0.0, 1.0);
  const bool is_mounted_anew = part(random) < 0.5;
  return {.delay_s = 0.5e-3 + 2.5e-3 * part(random),
          .magnitude = 0.8 + 0.4 * part(random),
          .noise = std::pow(10.0, -4.0 + part(random)),
          .clock_rel = 1e-4 * (part(random) - 0.5),
          .mounting_rel = is_mounted_anew ? 5e-3 : 0.0,
          .mounting_s = is_mounted_anew ? 5e-6 : 0.0};
}

Recipe make_recipe(const DrawnOptions& options) {
  Recipe recipe;
  const bool by_series = options.method == EvaluationMethod::series_timestamping;
  recipe.roles = {.method = options.method,
                  .reference = {"acs", "reference"},
                  .sync_acs = ChannelName{"acs", "sync"},
                  .sync_sensor = ChannelName{by_series ? "dso" : "dau", "sync"},
                  .dut = {{"dau", "x"}, {"dau", "y"}}};
  const auto add = [&](std::uint32_t sweep, const char* hz) {
    recipe.steps.push_back({.step = static_cast<std::uint32_t>(recipe.steps.size() + 1),
                            .repetition = sweep,
                            .frequency_text_hz = hz,
                            .frequency = *analysis::Frequency::parse(hz),
                            .level_m_s2 = level_m_s2,
                            .duration_s = 3.0});
  };
  constexpr std::array frequencies{"12.5", "20", "31.5", "50", "80", "125"};
  for (std::uint32_t sweep = 1; sweep <= options.repetitions; ++sweep) {
    for (std::size_t i = 0; i < options.points; ++i) {
      add(sweep, frequencies.at(i));
    }
  }
  if (options.repeat_first) {
    add(options.repetitions + 1, frequencies.front());
  }
  return recipe;
}

analysis::ChannelFit fit_of(const std::string& channel, double hz, double u_hz) {
  analysis::SineFit sine;
  sine.sine = level_m_s2;
  return {.channel = channel,
          .frequency = analysis::Frequency::from_hz(hz),
          .u_frequency_hz = u_hz,
          .fit = sine};
}

StepResult result_of(const RecipeStep& step, const std::string& channel) {
  StepResult result;
  result.channel = channel;
  result.step = step.step;
  result.repetition = step.repetition;
  result.frequency_text_hz = step.frequency_text_hz;
  result.frequency_hz = step.frequency.hz();
  result.level_m_s2 = step.level_m_s2;
  result.valid = true;
  result.unit = R"(\one)";
  return result;
}

// What the method does not have, and what it has in its place.
void by_method(EvaluationMethod method, double rate, double noise, StepResult& result) {
  if (method == EvaluationMethod::sample_timestamping) {
    constexpr double u_s = 1e-7;
    result.clock_link =
        analysis::ClockLink{.offset_s = u_s * noise, .u_sync_s = u_s, .u_stamps_s = u_s};
    return;
  }
  // Of reference, syncs and the channel.
  result.fits.erase(result.fits.begin() + (method == EvaluationMethod::series_timestamping ? 2 : 1),
                    result.fits.end() - 1);
  if (method == EvaluationMethod::series_timestamping) {
    constexpr double u_hz = 1e-4;
    result.series = SeriesFinding{.sample_rate_hz = 1.01 * rate_hz * rate + u_hz * noise,
                                  .u_sample_rate_hz = u_hz,
                                  .start = "at_trigger",
                                  .start_scatter_s = 1e-7};
  }
}

} // namespace

DrawnRun draw_run(unsigned seed, const DrawnOptions& options) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Drawn drawn = draw(random);
  DrawnRun run{make_recipe(options), {}};
  std::vector<std::pair<double, double>> mountings(options.repetitions);
  for (auto& [rel, late_s] : mountings) {
    rel = drawn.mounting_rel * normal(random);
    late_s = drawn.mounting_s * normal(random);
  }
  constexpr double u_clock_rel = 1e-8;
  for (const RecipeStep& step : run.recipe.steps) {
    const double w = 2.0 * pi * step.frequency.hz();
    const auto& [mounted_rel, mounted_s] =
        mountings[std::min<std::size_t>(step.repetition, mountings.size()) - 1];
    const double acs_hz = step.frequency.hz() * (1.0 + u_clock_rel * normal(random));
    const double dau_hz = acs_hz * (1.0 - drawn.clock_rel) * (1.0 + u_clock_rel * normal(random));
    const double begin_s = 5.0 * step.step + 1e-3 * std::abs(normal(random));
    for (std::size_t k = 0; k < options.channels; ++k) {
      StepResult result = result_of(step, "dau/" + std::string(1, static_cast<char>('x' + k)));
      const double u = drawn.noise;
      result.magnitude = drawn.magnitude * (1.0 + mounted_rel + u * normal(random));
      result.phase_rad =
          std::remainder(-w * (drawn.delay_s + mounted_s) + u * normal(random), 2.0 * pi);
      result.u_magnitude = u * result.magnitude;
      result.u_phase_rad = u;
      result.budget = {
          {.kind = analysis::ContributionKind::fit_noise, .u_magnitude_rel = u, .u_phase_rad = u}};
      const double u_hz = u_clock_rel * step.frequency.hz();
      result.fits = {fit_of("acs/reference", acs_hz, u_hz), fit_of("acs/sync", acs_hz, u_hz),
                     fit_of("dau/sync", dau_hz, u_hz), fit_of(result.channel, dau_hz, u_hz)};
      const auto first_ns = static_cast<std::int64_t>(1e9 * begin_s);
      constexpr std::int64_t samples = 3000;
      result.samples = {{.source = "dau",
                         .used = samples,
                         .first_stamp_ns = first_ns,
                         .last_stamp_ns = first_ns + (samples - 1) * 1'000'000}};
      by_method(options.method, dau_hz / acs_hz, normal(random), result);
      run.results.push_back(std::move(result));
    }
  }
  return run;
}

std::vector<Closure> DrawnRun::closures() const {
  return closures_after([](TransferFunction&) {});
}

std::vector<Closure>
DrawnRun::closures_after(const std::function<void(TransferFunction&)>& fault) const {
  TransferSummary summary(recipe);
  for (const StepResult& result : results) {
    summary.add(result);
  }
  auto functions = summary.transfer_functions();
  if (!functions.empty()) {
    fault(functions.front());
  }
  (void)add_closures({recipe, R"(\metre\second\tothe{-2})", [](const auto&) { return rate_hz; }},
                     results, functions);
  return functions.empty() ? std::vector<Closure>{} : functions.front().closures;
}

std::vector<StepResult> DrawnRun::flagged() const {
  TransferSummary summary(recipe);
  for (const StepResult& result : results) {
    summary.add(result);
  }
  auto functions = summary.transfer_functions();
  return add_closures({recipe, R"(\metre\second\tothe{-2})", [](const auto&) { return rate_hz; }},
                      results, functions);
}

} // namespace dyncal::inline evaluation
