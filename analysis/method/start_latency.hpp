// Does a sensor that records after a trigger start with the trigger, or with its next own sample?
//
// Judged from when the series of repeated shots began, relative to their mean (phase of each shot
// over w). A fixed start scatters with the uncertainty u of one shot; a sensor that runs free
// starts anywhere within one sample interval T, uniformly: standard deviation T / sqrt(12), mean T
// / 2 late.
//
// The likelihoods of N(0, u^2) and of the rectangle T convolved with it are compared: the better
// one must be 20 times as likely and must itself explain the scatter s, below 3 u for a fixed
// start, within 0.3 .. 2 of T / sqrt(12) for a uniform one. Anything else, or fewer than three
// shots, is undecided: then nothing is corrected. A step that is undecided because it resolves too
// little (a low frequency) may be told by other steps of its run; one whose shots scatter more than
// that start explains (a shot that does not belong to its trigger) may not. Any thread.
#pragma once

#include <span>

namespace dyncal::analysis {

enum class StartKind { undecided, fixed, uniform };

struct StartLatency {
  StartKind kind = StartKind::undecided;
  double scatter_s = 0.0;            // standard deviation between shots
  double log_likelihood_ratio = 0.0; // of uniform against fixed
  bool too_wide_for_fixed = false;   // the scatter: above what this start explains
  bool too_wide_for_uniform = false;

  // The own kind; where that is undecided, the one that other steps tell, unless this scatter
  // contradicts it.
  [[nodiscard]] StartKind kind_after(StartKind other_steps) const;
};

// `u_s`: standard uncertainty of one offset without any scatter of the start; `sample_s`: T.
[[nodiscard]] StartLatency judge_start_latency(std::span<const double> offsets_s, double u_s,
                                               double sample_s);

[[nodiscard]] const char* to_string(StartKind kind);

} // namespace dyncal::analysis
