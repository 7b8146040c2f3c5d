// The step q of a converter, found from the values that it gave: the greatest step of which all
// differences are whole multiples.
//
//   v_i - v_j = m_ij q,   m_ij whole, for nearly all neighbours in the sorted list of values
//
// Needed where nobody stated it: a few steps of signal without noise look like a pure sine with an
// amplitude wrong by several per cent. A step is believed when values of continuous noise would fit
// it less than once in a million, or when the values repeat so often that they come from a few
// levels. 0: none shows (continuous values, a converter much finer than the noise of its numbers, a
// constant). Values that do not fit, at most one in a hundred, may be interpolated ones.
//
// Looks at 4096 values at most, spread over the record. Unit: that of the values. Any thread.
#pragma once

#include <span>

namespace dyncal::analysis {

[[nodiscard]] double found_resolution(std::span<const double> values);

} // namespace dyncal::analysis
