// When does a sensor that records after a trigger take its first sample?
//
// Judged from when the series of repeated shots began, x_j, relative to each other (phase of each
// shot over w), with the uncertainty u of one of them and the sample interval T. What the shots
// show is scatter; what counts is the mean latency l, which no scatter shows by itself. The
// hypotheses:
//
//   fixed      x_j ~ N(m, u^2)                                                       l = 0
//   uniform    the sensor runs freely: + a rectangle of width T                      l = T / 2
//   fraction   of a faster clock, or of a grid: + a rectangle of width W < T         l = W / 2
//   waiting    for something that comes at random: + an exponential of mean s        l = s
//   jitter     about its mean: + N(0, s^2)                                           l = 0
//
// Their likelihoods are integrated over the unknown m (flat), W and s (flat in the logarithm),
// which is what a free parameter costs, and weighted by what is known beforehand: 0.42 fixed, 0.33
// uniform, 0.25 the others; or, where other steps of the run have told, 0.93 their kind. A kind is
// decided where it is probable: fixed above 0.3 (the others tend to it for small s) with uniform
// below 0.05, uniform above 0.6. For uniform the half sample is corrected; else nothing is. What
// remains is in
//
//   u(l)^2 = sum over all hypotheses of P (l - what is corrected)^2
//
// so an undecided step has an uncertainty that holds all that is plausible. Fewer than three shots
// decide nothing by themselves. Any thread.
#pragma once

#include <span>

namespace dyncal::analysis {

enum class StartKind { undecided, fixed, uniform };

struct StartLatency {
  StartKind kind = StartKind::undecided;
  double scatter_s = 0.0;         // standard deviation between shots
  double latency_s = 0.0;         // l, to be corrected
  double u_latency_s = 0.0;       // of the mean latency, common to all shots
  double probability_fixed = 0.0; // after the shots were seen
  double probability_uniform = 0.0;
};

// `u_s`: standard uncertainty of one offset without any scatter of the start; `sample_s`: T;
// `other_steps`: the kind that other steps of the run have shown.
[[nodiscard]] StartLatency judge_start_latency(std::span<const double> offsets_s, double u_s,
                                               double sample_s,
                                               StartKind other_steps = StartKind::undecided);

[[nodiscard]] const char* to_string(StartKind kind);

} // namespace dyncal::analysis
