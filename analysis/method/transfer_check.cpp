#include "analysis/method/transfer_check.hpp"

#include <cmath>
#include <complex>
#include <vector>

#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {
namespace {

// Inputs of the quotient: A and B of every fit, then relative magnitude and phase of every other
// row.
struct DrawnChain {
  std::vector<InputQuantity> inputs;
  std::vector<InputCorrelation> correlations;

  void add_fit(const ChannelFit& channel) {
    const SineFit& fit = channel.fit;
    const double u_a = std::sqrt(fit.covariance[0]), u_b = std::sqrt(fit.covariance[3]);
    inputs.push_back({.name = channel.channel + " sine", .value = fit.sine, .u = u_a});
    inputs.push_back({.name = channel.channel + " cosine", .value = fit.cosine, .u = u_b});
    if (u_a > 0.0 && u_b > 0.0) {
      correlations.push_back(
          {inputs.size() - 2, inputs.size() - 1, fit.covariance[1] / (u_a * u_b)});
    }
  }
  void add_row(const Contribution& row) {
    inputs.push_back({.name = row.name() + ", magnitude",
                      .u = row.u_magnitude_rel,
                      .distribution = row.distribution});
    inputs.push_back(
        {.name = row.name() + ", phase", .u = row.u_phase_rad, .distribution = row.distribution});
  }
};

bool is_drawn_as_phasor(const Contribution& row) {
  return row.kind == ContributionKind::fit_noise || row.kind == ContributionKind::rice;
}

// Of the sensor, the reference and, if there are, sync in the ACS and in the DAU.
std::complex<double> quotient(std::span<const double> drawn, std::size_t phasors) {
  const auto phasor = [&](std::size_t i) {
    return std::complex<double>(drawn[2 * i], drawn[2 * i + 1]);
  };
  const std::complex<double> h = phasor(0) / phasor(1);
  return phasors == 2 ? h : h * unit_phasor(phasor(2)) / unit_phasor(phasor(3));
}

} // namespace

Expected<TransferCheck> check_transfer(const TransferPoint& point, std::span<const ChannelFit> link,
                                       const MonteCarloSettings& settings) {
  if (link.empty() || link.size() > 3) {
    return fail(ErrorCode::invalid_argument, "a reference is needed, and at most two syncs");
  }
  if (link.size() == 2) { // this sync gives the frequency alone
    link = link.first(1);
  }
  DrawnChain chain;
  chain.add_fit(point.dut);
  for (const ChannelFit& channel : link) {
    chain.add_fit(channel);
  }
  const std::size_t phasors = 1 + link.size();
  std::vector<double> estimates;
  for (const InputQuantity& input : chain.inputs) {
    estimates.push_back(input.value);
  }
  for (const Contribution& row : point.budget) {
    if (!is_drawn_as_phasor(row)) {
      chain.add_row(row);
    }
  }
  const std::complex<double> corrections = point.h / quotient(estimates, phasors);
  const auto model = [&](std::span<const double> drawn, std::span<double> outputs) {
    std::complex<double> h = quotient(drawn, phasors) * corrections;
    for (std::size_t row = 2 * phasors; row < drawn.size(); row += 2) {
      h *= (1.0 + drawn[row]) * std::polar(1.0, drawn[row + 1]);
    }
    outputs[0] = std::abs(h);
    outputs[1] = point.phase_rad + wrap_phase(std::arg(h) - point.phase_rad);
  };
  auto results = propagate_distributions(chain.inputs, chain.correlations, 2, model, settings);
  if (!results) {
    return results.error().code == ErrorCode::not_finite
               ? fail(ErrorCode::not_finite, "a drawn phasor was 0")
               : fail(results.error());
  }
  return TransferCheck{(*results)[0], (*results)[1]};
}

} // namespace dyncal::analysis
