// The Monte Carlo cross-check of one value of the transfer function: the better answer near
// |H| = 0 and for A/u below 5.
//
// Drawn are the phasors of the sensor and of `link`, with the covariances of their coefficients,
// and every other row of the point's budget as it stands there. `link` is the reference alone
// (paper eqs. (1), (2)), beside it the sync that only gave the frequency, or reference, sync in the
// ACS and sync in the DAU (eqs. (3), (4)).
// Corrections are constants: what the point has beside the quotient of its phasors. Raw data is
// never resampled. Phases are taken about the evaluated one, so an interval across +-pi is whole.
//
// Fails as monte_carlo.hpp does, and with invalid_argument (no reference, or too many). Any thread.
#pragma once

#include <span>

#include "analysis/base/error.hpp"
#include "analysis/method/transfer_point.hpp"
#include "analysis/uncertainty/monte_carlo.hpp"

namespace dyncal::analysis {

struct TransferCheck {
  MonteCarloResult magnitude;
  MonteCarloResult phase_rad;
};

[[nodiscard]] Expected<TransferCheck> check_transfer(const TransferPoint& point,
                                                     std::span<const ChannelFit> link,
                                                     const MonteCarloSettings& settings = {});

} // namespace dyncal::analysis
