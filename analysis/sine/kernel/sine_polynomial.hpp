// Sine and cosine of an angle given in turns, after exact reduction: polynomials on an eighth of a
// turn, |r| <= 0.12525.
//
//   sin(2 pi r) = r S(r^2),   cos(2 pi r) = 1 + r^2 C(r^2)
//
// Minimax coefficients (Remez, 50 digits, then rounded): the polynomials are within 1.9e-17 of the
// functions, the evaluated values within 1.3e-16. No allocation, no dependence on the standard
// library: the vector kernels include this file too.
#pragma once

namespace dyncal::analysis::kernel {

inline constexpr double sine_coefficients[7] = {
    0x1.921fb54442d18p+2, -0x1.4abbce625be20p+5, 0x1.466bc67756643p+6, -0x1.32d2cce115713p+6,
    0x1.50782e558aae5p+5, -0x1.e2ff3989beb02p+3, 0x1.e3930fe4ae81fp+1};
inline constexpr double cosine_coefficients[7] = {
    -0x1.3bd3cc9be45dep+4, 0x1.03c1f081b5ab0p+6, -0x1.55d3c7e3c94e2p+6, 0x1.e1f506839df2ep+5,
    -0x1.a6d1eca50b7ddp+4, 0x1.f9cc5c3df56d2p+2, -0x1.b26b6028836dap+0};

// Adding it rounds to an integer and leaves that integer in the low bits: 1.5 * 2^52.
inline constexpr double rounding_shift = 6755399441055744.0;

} // namespace dyncal::analysis::kernel
