// Where the search for the parameters of a response begins, so that whole turns of the phase
// between distant frequencies do not fool it.
//
// Corner and resonance frequencies from below to far above what was measured, and several dampings,
// are tried. With each, the delay for which all phases agree best with a model that has phase 0 or
// pi at 0 Hz is searched over +-1.25 of the inverse of the smallest frequency spacing (at most
// 10 000 steps of 1 / (8 f_max) to either side); every peak that stands out is a hypothesis of its
// own. Frequencies on a grid of spacing D cannot tell tau from tau + 1 / D: both are then returned.
//
// The starts are those with the lowest sum of weighted squares, a few for each delay. Plain
// function, any thread.
#pragma once

#include <span>
#include <vector>

#include "analysis/response/response_model.hpp"

namespace dyncal::analysis {

// Best first. REQUIRES: at least one point, all frequencies, magnitudes and uncertainties positive.
[[nodiscard]] std::vector<ResponseParameters>
response_starts(ResponseKind kind, std::span<const ResponsePoint> points);

} // namespace dyncal::analysis
