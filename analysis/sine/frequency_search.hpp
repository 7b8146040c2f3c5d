// Where the frequency lies, to a small part of a bin 1/T: the start of the four-parameter fit,
// whose iteration only finds the optimum from within 0.6 of a bin.
//
// Few bins or few cycles: the three-parameter residual on a grid of frequencies, which includes the
// constant and the image at -f and so holds below three cycles. Many bins: phasors of short cells
// at the start frequency, by real time (gaps are empty cells), and their padded discrete Fourier
// transform. Channels count by their signal over their own scatter. Looks at part of a long record
// first, and at all of it when nothing is significant there. Any thread.
#pragma once

#include <span>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/sine/sine_pass.hpp"

namespace dyncal::analysis::kernel {

// Best frequency within start * (1 +- search_rel). Fails as accumulate() does.
[[nodiscard]] Expected<Frequency> search_frequency(const Record& record, const Frequency& start,
                                                   double search_rel);

} // namespace dyncal::analysis::kernel
