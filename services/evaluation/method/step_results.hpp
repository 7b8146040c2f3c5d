// From the evaluated channels of a step to its results: what results of every method have in
// common. Plain functions, any thread.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/method/step_findings.hpp"
#include "analysis/method/transfer_point.hpp"
#include "services/evaluation/method/selected_channels.hpp"
#include "services/evaluation/method/signal_check.hpp"
#include "services/evaluation/method/step_task.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

// What the evaluation of a step gives: fits that are common to all channels, and one point a
// channel.
struct EvaluatedStep {
  std::vector<analysis::ChannelFit> common_fits;
  std::vector<analysis::TransferPoint> points;
  analysis::StepFindings findings{};
};

// A channel among those that were selected, which outlives it; of a fit without samples: none.
struct SelectedChannel {
  const SelectedChannels* selected = nullptr;
  std::size_t index = 0;
};

// What it was made from.
struct StepInput {
  std::vector<ChannelName> dut; // in the order of the points
  std::string reference_unit;
  std::vector<std::string> units;
  std::vector<SourceSamples> samples;
  std::string data_sha256;
  std::vector<SelectedChannel> common; // in the order of the common fits
  SelectedChannel first_dut;           // the points are of this channel and those after it
  // Of a multi-sine: what its lines leave of each of these channels, in their order.
  std::span<const std::vector<double>> rests{};
};

// Everything but the numbers: not valid, magnitude and phase NaN.
[[nodiscard]] StepResult result_head(const RecipeStep& step, const ChannelName& channel);

// The results of a step without a value.
[[nodiscard]] std::vector<StepResult> results_without_value(const RecipeStep& step,
                                                            const std::vector<ChannelName>& dut,
                                                            const std::string& problem);

// One result a channel: value, fits, budget, what it was made of, flags, and the check by Monte
// Carlo when the recipe asks for one. Where the evaluation failed, or the samples of the channel or
// of the reference refuse it (signal_check.hpp): results without a value.
[[nodiscard]] std::vector<StepResult> make_results(const StepTask& task, const StepInput& input,
                                                   const analysis::Expected<EvaluatedStep>& step);

// Gives the numbers of a check, flags what it has found; takes the value away where it refuses it.
void add_check(const SignalCheck& check, StepResult& result);

// Takes the value away, where there is one.
void add_refusal(const std::string& sentence, StepResult& result);

// Flags a level that is off the plan and samples that were left out, and adds up what was lost.
// REQUIRES: the first of the result's fits is that of the reference.
void add_input(const StepTask& task, const StepInput& input, StepResult& result);

// Output per input for every channel of `dut` from `first_dut` on.
[[nodiscard]] std::vector<std::string> units_of(const SelectedChannels& acs,
                                                const SelectedChannels& dut, std::size_t first_dut);

} // namespace dyncal::inline evaluation
