// Compiled for AVX2; entered only when the processor has it.
#include "analysis/interferometer/kernel/arctangent_polynomial.hpp"
#include "analysis/interferometer/kernel/quadrature_kernel.hpp"

#include "analysis/interferometer/kernel/quadrature_kernel_body.hpp"

namespace dyncal::analysis::kernel {
const QuadratureKernel avx2_quadrature_kernel{
    "avx2",     phase_of<std::int16_t>,       phase_of<float>,   phase_of<double>,
    moments_of, fourth_difference_squares_of, sum_of_products_of};
}
