// The Monte Carlo cross-check of one result (JCGM 101) as the contract publishes it: the uncertainty that the budget gives beside the one
// that drawing from it gives. Both agree for a sound result; where they do not (|H| near 0, little excitation), the interval is the better
// answer. Fails as analysis/monte_carlo.hpp does. Any thread.
#pragma once

#include <cstddef>
#include <cstdint>

#include "analysis/sample_stamping.hpp"
#include "idl/dyncal.h"
#include "services/error.hpp"

namespace dyncal::services {

// Of the channel `point` of a step; the seed is fixed, so that the same samples give the same bits.
[[nodiscard]] Expected<MonteCarloCheck> monte_carlo_check(const analysis::SampleStampingInput& input,
                                                          const analysis::SampleStampingResult& result, std::size_t point,
                                                          std::uint64_t trials);

} // namespace dyncal::services
