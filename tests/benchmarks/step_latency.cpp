// How long a step's result takes from the arrival of the block that ends the step, in the
// evaluation as the analysis service runs it, messages of the results included; and how long the
// same takes when the step is evaluated only then.
//   step_latency [--runs 5] [--short]
// Five channels: reference and sync of an ACS, sync and two sensor channels of a DAU. Blocks of 10
// ms. The longest of the steps of a run counts, and of the runs the quickest. "other block" is the
// longest time that anything else takes: the block with which the planned samples are complete.
// Exit status 1 when a step's result was not there when its end was found.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "idl/dyncal.h"
#include "services/evaluation/result/result_messages.hpp"
#include "services/evaluation/run_evaluator.hpp"

namespace {

using namespace dyncal;
using Clock = std::chrono::steady_clock;

constexpr double block_s = 0.01;
constexpr double off_s = 0.5;
constexpr double settling_s = 0.2;
constexpr double margin_s = 0.4; // for which a run excites a step beyond its plan
constexpr double noise = 1e-3;

struct Case {
  double duration_s;
  double acs_rate_hz;
  double dau_rate_hz;
  double frequency_hz = 80.0;
  bool in_time = true; // false: the excitation ends before its planned samples have come
};

struct Latency {
  double last_block_ms = 0.0;
  double other_block_ms = 0.0;
};

Recipe recipe_of(const Case& one) {
  Recipe recipe;
  recipe.bench = "latency";
  recipe.run = "r1";
  recipe.roles = {.reference = {"acs", "reference"},
                  .sync_acs = {"acs", "sync"},
                  .sync_sensor = {"dau", "sync"},
                  .dut = {{"dau", "x"}, {"dau", "z"}}};
  recipe.u_adc_delay_s = 1e-7;
  for (std::uint32_t step = 1; step <= 2; ++step) {
    recipe.steps.push_back({.step = step,
                            .repetition = 1,
                            .frequency_text_hz = fmt::format("{}", one.frequency_hz),
                            .frequency = analysis::Frequency::from_hz(one.frequency_hz),
                            .level_m_s2 = 10.0,
                            .settling_s = settling_s,
                            .duration_s = one.duration_s});
  }
  return recipe;
}

drivers::SourceDescription description(const std::vector<std::string>& channels, double rate_hz) {
  drivers::SourceDescription described;
  described.nominal_rate_hz = rate_hz;
  for (const std::string& name : channels) {
    drivers::ChannelDescription channel;
    channel.name = name;
    channel.unit = name == "sync" ? R"(\volt)" : R"(\metre\second\tothe{-2})";
    described.channels.push_back(channel);
  }
  return described;
}

// A source and the block that it sends next.
class Source {
public:
  Source(const Case& one, std::string name, std::vector<std::string> channels, double rate_hz)
      : case_(one), name_(std::move(name)), channels_(channels.size()), rate_hz_(rate_hz),
        random_(channels.size()), description_(description(channels, rate_hz)) {}

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const drivers::SourceDescription& described() const { return description_; }

  SourceBlock next_block() {
    const auto first = static_cast<std::uint64_t>(std::llround(sent_s_ * rate_hz_));
    sent_s_ += block_s;
    const auto end = static_cast<std::uint64_t>(std::llround(sent_s_ * rate_hz_));
    const std::size_t samples = end - first;
    values_.resize(samples * channels_);
    stamps_ns_.resize(samples);
    for (std::size_t i = 0; i < samples; ++i) {
      const double t_s = static_cast<double>(first + i) / rate_hz_;
      stamps_ns_[i] = 1'700'000'000'000'000'000 + std::llround(t_s * 1e9);
      const double value = excitation(t_s);
      for (std::size_t channel = 0; channel < channels_; ++channel) {
        values_[channel * samples + i] = 10.0 * (value + noise_(random_));
      }
    }
    SourceBlock block;
    block.session = 1;
    block.number = number_++;
    block.first_sample = first;
    block.samples = samples;
    block.channels = channels_;
    block.stamps_ns = stamps_ns_;
    block.values = values_;
    return block;
  }

private:
  [[nodiscard]] double excitation(double t_s) const {
    const double on_s = settling_s + case_.duration_s + (case_.in_time ? margin_s : -0.15);
    const double in_step_s = std::fmod(t_s, on_s + off_s) - off_s;
    return in_step_s < 0.0 ? 0.0 : std::sin(2.0 * std::numbers::pi * case_.frequency_hz * t_s);
  }

  const Case& case_;
  std::string name_;
  std::size_t channels_;
  double rate_hz_;
  std::mt19937_64 random_;
  std::normal_distribution<double> noise_{0.0, noise};
  drivers::SourceDescription description_;
  double sent_s_ = 0.0;
  std::uint64_t number_ = 0;
  std::vector<double> values_;
  std::vector<std::int64_t> stamps_ns_;
};

// What the service would publish is made; its size keeps the compiler from leaving it out.
std::size_t publish(const Recipe& recipe, const EvaluationOutput& output) {
  std::size_t flags = 0;
  for (const StepResult& result : output.results) {
    if (!result.valid) {
      throw std::runtime_error(result.problem);
    }
    flags += to_message(recipe, result).flags().size();
  }
  return flags;
}

Latency run_once(const Case& one, bool ahead) {
  RunEvaluator evaluator(recipe_of(one), {.ahead = ahead});
  std::vector<Source> sources;
  sources.emplace_back(one, "acs", std::vector<std::string>{"reference", "sync"}, one.acs_rate_hz);
  sources.emplace_back(one, "dau", std::vector<std::string>{"x", "z", "sync"}, one.dau_rate_hz);
  for (const Source& source : sources) {
    if (const auto described = evaluator.describe(source.name(), source.described()); !described) {
      throw std::runtime_error(described.error().message);
    }
  }
  Latency latency;
  std::size_t results = 0;
  while (results < 4) {
    for (Source& source : sources) {
      const SourceBlock block = source.next_block();
      auto begin = Clock::now();
      evaluator.add(source.name(), block);
      for (bool any = true; any;) {
        const EvaluationOutput output = evaluator.take_output();
        publish(evaluator.recipe(), output);
        any = !output.results.empty();
        const auto end = Clock::now();
        double& longest = any ? latency.last_block_ms : latency.other_block_ms;
        longest = std::max(longest, std::chrono::duration<double, std::milli>(end - begin).count());
        results += output.results.size();
        begin = end;
      }
    }
    if (evaluator.finished() && results < 4) {
      throw std::runtime_error("a step without results");
    }
  }
  if (ahead && evaluator.steps_ready() != (one.in_time ? 2U : 0U)) {
    throw std::runtime_error("the result of a step was not there when its end was found");
  }
  return latency;
}

Latency quickest(const Case& one, bool ahead, int runs) {
  Latency best{1e9, 1e9};
  for (int run = 0; run < runs; ++run) {
    const Latency latency = run_once(one, ahead);
    best.last_block_ms = std::min(best.last_block_ms, latency.last_block_ms);
    best.other_block_ms = std::min(best.other_block_ms, latency.other_block_ms);
  }
  return best;
}

} // namespace

int main(int argc, char** argv) try {
  int runs = 5;
  bool is_short = false;
  CLI::App app("Measures the time from the last block of a step to its result.");
  app.add_option("--runs", runs, "of which the quickest counts")->check(CLI::Range(1, 100));
  app.add_flag("--short", is_short, "the smallest cases alone");
  CLI11_PARSE(app, argc, argv);
  std::vector<Case> cases;
  for (const double duration_s : {1.0, 10.0}) {
    for (const auto& [acs_hz, dau_hz] : {std::pair{10e3, 1e3}, std::pair{10e3, 10e3},
                                         std::pair{100e3, 1e3}, std::pair{100e3, 100e3}}) {
      cases.push_back({duration_s, acs_hz, dau_hz});
    }
  }
  cases.push_back({10.0, 100e3, 1e3, 5.0});
  cases.push_back({10.0, 100e3, 1e3, 80.0, false});
  if (is_short) {
    cases = {cases.front(), {1.0, 10e3, 1e3, 80.0, false}};
  }
  fmt::print("{:>5} {:>8} {:>8} {:>6} {:12} {:>14} {:>14} {:>20}\n", "s", "ACS Hz", "DAU Hz", "Hz",
             "ends", "last block/ms", "other block/ms", "evaluated then/ms");
  for (const Case& one : cases) {
    const Latency ahead = quickest(one, true, runs);
    const Latency then = quickest(one, false, runs);
    fmt::print("{:5} {:8} {:8} {:6} {:12} {:14.3f} {:14.3f} {:20.3f}\n", one.duration_s,
               one.acs_rate_hz, one.dau_rate_hz, one.frequency_hz,
               one.in_time ? "as planned" : "too soon", ahead.last_block_ms, ahead.other_block_ms,
               then.last_block_ms);
  }
  return 0;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "step_latency: %s\n", problem.what());
  return 1;
}
