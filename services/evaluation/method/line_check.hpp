// Which lines a channel could not tell from the excitation of a step, and what the step and the
// quiet time before it tell of those that some step of the recipe cannot tell: for the end of the
// run, where one bounds the other (line_bounds.hpp).
//
// Measured are only lines that a step of the recipe may need, at the sample rate this channel has:
// lines of the mains that it cannot tell with their kindred, or else whatever there is at its own
// frequency. In quiet
// time a line counts only where it is shown to last: an excitation that dies away is no hum. Plain
// functions, any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "analysis/method/transfer_point.hpp"
#include "services/evaluation/method/selected_channels.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/channel_lines.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

// What a channel is in the evaluation.
struct LineSubject {
  std::string name;
  bool counts_in_magnitude = true;
};

[[nodiscard]] ChannelLines check_lines(const Recipe& recipe, const LineSubject& subject,
                                       const analysis::ChannelFit& fit,
                                       std::span<const std::int64_t> stamps_ns,
                                       std::span<const double> values);

// Channel `index` of what was selected, and of the quiet time before.
[[nodiscard]] ChannelLines check_lines(const Recipe& recipe, const LineSubject& subject,
                                       const analysis::ChannelFit& fit,
                                       const SelectedChannels& selected, std::size_t index);

// Of a line of a multi-sine: `rest` is what all its lines leave of the channel. What is at a line
// itself does not show there, and is left to the quiet time.
[[nodiscard]] ChannelLines check_lines_beside(const Recipe& recipe, const LineSubject& subject,
                                              const analysis::ChannelFit& fit,
                                              const SelectedChannels& selected, std::size_t index,
                                              std::span<const double> rest);

// Low multiples of the same mains with the same parity (rectifiers make even ones), which show
// whether there is hum at all where the line itself is never told from an excitation.
[[nodiscard]] std::vector<double> kindred_lines_hz(const analysis::UnresolvedLine& line);

// Gives a valid result its lines, and a flag for each that could not be told: it is provisional
// then.
void add_lines(std::vector<ChannelLines> lines, StepResult& result);

// "dau/dos: hum at 50 Hz cannot be told from the excitation".
[[nodiscard]] Flag flag_of_line(const std::string& channel, const analysis::UnresolvedLine& line);

} // namespace dyncal::inline evaluation
