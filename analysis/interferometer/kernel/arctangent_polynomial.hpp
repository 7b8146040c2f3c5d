// The arctangent in turns on |t| <= tan(pi/8):
//
//   atan(t) / 2 pi = t C(t^2)
//
// Minimax coefficients for the relative error (Remez, 50 digits, then rounded): the polynomial is
// within 1.2e-16 of the function. No dependence on the standard library: every variant of the
// kernel includes this file.
#pragma once

#include <cstddef>

namespace dyncal::analysis::kernel {

inline constexpr std::size_t arctangent_terms = 11;
inline constexpr double arctangent_coefficients[arctangent_terms] = {
    0x1.45f306dc9c882p-3, -0x1.b2995e7b7b1cap-5, 0x1.04c26be372390p-5, -0x1.74837561b31a9p-6,
    0x1.21bb8c0f0cf65p-6, -0x1.da19e3181d9a1p-7, 0x1.910c0b7c23e80p-7, -0x1.5a4ffc0f9fc6dp-7,
    0x1.28b745ef0dbb7p-7, -0x1.c5d59d9206355p-8, 0x1.b9a2bcea981d1p-9};

inline constexpr double tangent_of_an_eighth_pi = 0x1.a827999fcef32p-2;

} // namespace dyncal::analysis::kernel
