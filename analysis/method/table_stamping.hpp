// Sample time stamping against a reference that its system has evaluated itself: of a step it hands
// out an amplitude and a phase in place of samples. Eqs. (3), (4) of sample_stamping.hpp with
//
//   P_ref := a_T (phase 0),   P_sync,ACS := e^{i psi_T},   psi_T = theta_sync - theta_ref
//   |H| = |P_dos| / a_T,   arg H = arg(P_dos conj(P_sync,dau)) - lag_ADC(w) + psi_T - w tau_ref
//
// Side, window and frequency of the DAU are as there: its sync is the pilot. The instant of the
// reference drops out. Rows of the budget that are not there:
//
//   noise of the reference's table   u(a_T) / a_T and u(psi_T), both in the phasor of the reference
//                                    and in none other; what a table has is not known to average,
//                                    so repetitions have it in common
//   simultaneity   the two systems average over other parts of the step. 0 where the windows are
//                  the same; else what |P_dos| and arg(P_dos / P_sync) drift along the DAU's record
//                  (block_drift.hpp), as for an overlap that is not known
//
// What the sensor does along the step cannot be told from what the exciter does, so that no change
// within a step is found. Fails as sample_stamping.hpp does, and with invalid_argument where the
// table has no amplitude above 0 or an uncertainty that is none. Any thread.
#pragma once

#include <string>

#include "analysis/method/sample_stamping.hpp"

namespace dyncal::analysis {

struct EvaluatedReference {
  std::string channel; // names of the fits that are made of it
  std::string sync_channel;
  double amplitude = 0.0; // a_T, of the excitation
  double u_amplitude = 0.0;
  double phase_rad = 0.0; // psi_T, of sync against the reference
  double u_phase_rad = 0.0;
  bool same_window = false; // as the DAU's record
};

// The fits of the reference and of its sync, as the table says.
[[nodiscard]] ChannelFit reference_fit(const Frequency& frequency,
                                       const EvaluatedReference& reference);
[[nodiscard]] ChannelFit reference_sync_fit(const Frequency& frequency,
                                            const EvaluatedReference& reference);

// Nothing of the ACS in `input` is looked at, nor its `dut_stamps_ns`.
[[nodiscard]] Expected<SampleStampingResult>
evaluate_table_stamping(const SampleStampingInput& input, const EvaluatedReference& reference);

} // namespace dyncal::analysis
