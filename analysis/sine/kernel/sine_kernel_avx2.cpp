// Compiled for AVX2 and FMA; entered only when the processor has them.
#include "analysis/sine/kernel/sine_kernel.hpp"
#include "analysis/sine/kernel/sine_polynomial.hpp"

#include <immintrin.h>

namespace {

struct Lanes {
  __m256d a, b; // lanes 0..3 and 4..7
  static constexpr std::size_t channels_at_once = 1;

  static Lanes all(double value) { return {_mm256_set1_pd(value), _mm256_set1_pd(value)}; }
  static Lanes load(const double* from) {
    return {_mm256_loadu_pd(from), _mm256_loadu_pd(from + 4)};
  }
  static Lanes mask(std::size_t count) {
    const __m256i n = _mm256_set1_epi64x(static_cast<long long>(count));
    return {_mm256_castsi256_pd(_mm256_cmpgt_epi64(n, _mm256_setr_epi64x(0, 1, 2, 3))),
            _mm256_castsi256_pd(_mm256_cmpgt_epi64(n, _mm256_setr_epi64x(4, 5, 6, 7)))};
  }
  void store(double* to) const {
    _mm256_storeu_pd(to, a);
    _mm256_storeu_pd(to + 4, b);
  }

  bool all_at_most(double limit) const {
    const __m256d bound = _mm256_set1_pd(limit);
    return _mm256_movemask_pd(_mm256_and_pd(_mm256_cmp_pd(a, bound, _CMP_LE_OQ),
                                            _mm256_cmp_pd(b, bound, _CMP_LE_OQ))) == 0xf;
  }

  double total() const {
    const __m256d pairs = _mm256_hadd_pd(a, b); // 0+1, 4+5, 2+3, 6+7
    const __m128d fours =
        _mm_add_pd(_mm256_castpd256_pd128(pairs), _mm256_extractf128_pd(pairs, 1));
    return _mm_cvtsd_f64(_mm_add_sd(fours, _mm_unpackhi_pd(fours, fours)));
  }

  double minimum() const {
    const __m256d four = _mm256_min_pd(a, b);
    const __m128d two = _mm_min_pd(_mm256_castpd256_pd128(four), _mm256_extractf128_pd(four, 1));
    return _mm_cvtsd_f64(_mm_min_sd(two, _mm_unpackhi_pd(two, two)));
  }
  double maximum() const {
    const __m256d four = _mm256_max_pd(a, b);
    const __m128d two = _mm_max_pd(_mm256_castpd256_pd128(four), _mm256_extractf128_pd(four, 1));
    return _mm_cvtsd_f64(_mm_max_sd(two, _mm_unpackhi_pd(two, two)));
  }
};

inline Lanes operator+(Lanes x, Lanes y) {
  return {_mm256_add_pd(x.a, y.a), _mm256_add_pd(x.b, y.b)};
}
inline Lanes operator-(Lanes x, Lanes y) {
  return {_mm256_sub_pd(x.a, y.a), _mm256_sub_pd(x.b, y.b)};
}
inline Lanes operator*(Lanes x, Lanes y) {
  return {_mm256_mul_pd(x.a, y.a), _mm256_mul_pd(x.b, y.b)};
}
inline Lanes operator&(Lanes x, Lanes y) {
  return {_mm256_and_pd(x.a, y.a), _mm256_and_pd(x.b, y.b)};
}
inline Lanes fused(Lanes x, Lanes y, Lanes z) {
  return {_mm256_fmadd_pd(x.a, y.a, z.a), _mm256_fmadd_pd(x.b, y.b, z.b)};
}
inline Lanes fused_less(Lanes x, Lanes y, Lanes z) {
  return {_mm256_fnmadd_pd(x.a, y.a, z.a), _mm256_fnmadd_pd(x.b, y.b, z.b)};
}
inline Lanes fused_minus(Lanes x, Lanes y, Lanes z) {
  return {_mm256_fmsub_pd(x.a, y.a, z.a), _mm256_fmsub_pd(x.b, y.b, z.b)};
}

inline __m256i load_four(const std::int64_t* stamps) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(stamps));
}

// |integer| < 2^51: it is put into the mantissa of rounding_shift.
inline __m256d four_doubles(__m256i integers) {
  const __m256d shift = _mm256_set1_pd(dyncal::analysis::kernel::rounding_shift);
  return _mm256_sub_pd(_mm256_castsi256_pd(_mm256_add_epi64(integers, _mm256_castpd_si256(shift))),
                       shift);
}

inline __m256d four_differences(const std::int64_t* stamps, std::int64_t origin) {
  return four_doubles(_mm256_sub_epi64(load_four(stamps), _mm256_set1_epi64x(origin)));
}

inline __m256d four_differences(const std::int64_t* stamps, const std::int64_t* offsets,
                                std::int64_t origin) {
  return four_doubles(_mm256_sub_epi64(
      _mm256_sub_epi64(load_four(stamps), _mm256_set1_epi64x(origin)), load_four(offsets)));
}

inline Lanes time_difference(const std::int64_t* stamps, std::int64_t origin) {
  return {four_differences(stamps, origin), four_differences(stamps + 4, origin)};
}

inline Lanes time_difference(const std::int64_t* stamps, const std::int64_t* offsets,
                             std::int64_t origin) {
  return {four_differences(stamps, offsets, origin),
          four_differences(stamps + 4, offsets + 4, origin)};
}

inline __m256d larger_magnitude_of_four(__m256d a, __m256d b) {
  const __m256d sign = _mm256_set1_pd(-0.0);
  return _mm256_max_pd(_mm256_andnot_pd(sign, a), _mm256_andnot_pd(sign, b));
}

inline Lanes larger_magnitude(Lanes x, Lanes y) {
  return {larger_magnitude_of_four(x.a, y.a), larger_magnitude_of_four(x.b, y.b)};
}

inline Lanes smaller(Lanes x, Lanes y) {
  return {_mm256_min_pd(x.a, y.a), _mm256_min_pd(x.b, y.b)};
}
inline Lanes larger(Lanes x, Lanes y) {
  return {_mm256_max_pd(x.a, y.a), _mm256_max_pd(x.b, y.b)};
}

inline void turn_four(__m256d shifted, __m256d& sine, __m256d& cosine) {
  const __m256i k = _mm256_castpd_si256(shifted);
  const __m256d odd = _mm256_castsi256_pd(_mm256_slli_epi64(k, 63)); // blendv reads the top bit
  const __m256d upper = _mm256_castsi256_pd(_mm256_slli_epi64(k, 62));
  const __m256d sign = _mm256_set1_pd(-0.0);
  const __m256d s = _mm256_blendv_pd(sine, cosine, odd);
  const __m256d c = _mm256_blendv_pd(cosine, sine, odd);
  sine = _mm256_xor_pd(s, _mm256_and_pd(upper, sign));
  cosine = _mm256_xor_pd(c, _mm256_and_pd(_mm256_xor_pd(odd, upper), sign));
}

inline void turn_quadrants(Lanes shifted, Lanes& sine, Lanes& cosine) {
  turn_four(shifted.a, sine.a, cosine.a);
  turn_four(shifted.b, sine.b, cosine.b);
}

struct StepCheck {
  __m256i forward = _mm256_set1_epi64x(-1);
  void see(const std::int64_t* stamps, const std::int64_t* next) {
    forward = _mm256_and_si256(forward, _mm256_cmpgt_epi64(load_four(next), load_four(stamps)));
    forward =
        _mm256_and_si256(forward, _mm256_cmpgt_epi64(load_four(next + 4), load_four(stamps + 4)));
  }
  bool increasing() const { return _mm256_movemask_pd(_mm256_castsi256_pd(forward)) == 0xf; }
};

struct EqualCheck {
  __m256d equal = _mm256_setzero_pd();
  void see(Lanes x, Lanes y) {
    equal = _mm256_or_pd(equal, _mm256_or_pd(_mm256_cmp_pd(x.a, y.a, _CMP_EQ_OQ),
                                             _mm256_cmp_pd(x.b, y.b, _CMP_EQ_OQ)));
  }
  bool any() const { return _mm256_movemask_pd(equal) != 0; }
};

} // namespace

#include "analysis/sine/kernel/sine_kernel_body.hpp"

#include "analysis/sine/kernel/sine_grid_body.hpp"

#include "analysis/sine/kernel/sine_grid_series_body.hpp"

#include "analysis/sine/kernel/sine_model_body.hpp"

#include "analysis/sine/kernel/sine_lines_body.hpp"

namespace dyncal::analysis::kernel {
const SineKernel avx2_kernel{
    "avx2",          fit_on_grid,       series_on_grid,   fit_block,
    design,          design_with_slope, residuals,        residuals_with_slope,
    model_residuals, model_products,    design_with_time, residuals_with_time,
    line_sums,       value_range};
}
