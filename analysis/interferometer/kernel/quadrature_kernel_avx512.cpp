// Compiled for AVX-512 (F and DQ); entered only when the processor has them.
#include "analysis/interferometer/kernel/arctangent_polynomial.hpp"
#include "analysis/interferometer/kernel/quadrature_kernel.hpp"

#include "analysis/interferometer/kernel/quadrature_kernel_body.hpp"

namespace dyncal::analysis::kernel {
const QuadratureKernel avx512_quadrature_kernel{
    "avx512",   phase_of<std::int16_t>,       phase_of<float>,   phase_of<double>,
    moments_of, fourth_difference_squares_of, sum_of_products_of};
}
