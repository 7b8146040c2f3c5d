// Compiled for AVX-512 (F and DQ); entered only when the processor has them.
#include "analysis/sine/kernel/sine_kernel.hpp"
#include "analysis/sine/kernel/sine_polynomial.hpp"

#include <immintrin.h>

namespace {

struct Lanes {
  __m512d v;
  static constexpr std::size_t channels_at_once = 4;

  static Lanes all(double value) { return {_mm512_set1_pd(value)}; }
  static Lanes load(const double* from) { return {_mm512_loadu_pd(from)}; }
  static Lanes mask(std::size_t count) {
    return {_mm512_castsi512_pd(_mm512_maskz_set1_epi64(
        static_cast<__mmask8>(count >= 8 ? 0xff : (1u << count) - 1u), -1))};
  }
  void store(double* to) const { _mm512_storeu_pd(to, v); }

  bool all_at_most(double limit) const {
    return _mm512_cmp_pd_mask(v, _mm512_set1_pd(limit), _CMP_LE_OQ) == 0xff;
  }

  double total() const {
    const __m512d pairs = _mm512_add_pd(v, _mm512_permute_pd(v, 0x55)); // 0+1, 2+3, ...
    const __m512d fours =
        _mm512_add_pd(pairs, _mm512_shuffle_f64x2(pairs, pairs, 0xb1)); // (0+1)+(2+3)
    const __m256d sum =
        _mm256_add_pd(_mm512_castpd512_pd256(fours), _mm512_extractf64x4_pd(fours, 1));
    return _mm256_cvtsd_f64(sum);
  }

  double minimum() const { return _mm512_reduce_min_pd(v); }
  double maximum() const { return _mm512_reduce_max_pd(v); }
};

inline Lanes operator+(Lanes a, Lanes b) {
  return {_mm512_add_pd(a.v, b.v)};
}
inline Lanes operator-(Lanes a, Lanes b) {
  return {_mm512_sub_pd(a.v, b.v)};
}
inline Lanes operator*(Lanes a, Lanes b) {
  return {_mm512_mul_pd(a.v, b.v)};
}
inline Lanes operator&(Lanes a, Lanes b) {
  return {_mm512_and_pd(a.v, b.v)};
}
inline Lanes fused(Lanes a, Lanes b, Lanes c) {
  return {_mm512_fmadd_pd(a.v, b.v, c.v)};
}
inline Lanes fused_less(Lanes a, Lanes b, Lanes c) {
  return {_mm512_fnmadd_pd(a.v, b.v, c.v)};
}
inline Lanes fused_minus(Lanes a, Lanes b, Lanes c) {
  return {_mm512_fmsub_pd(a.v, b.v, c.v)};
}

inline Lanes time_difference(const std::int64_t* stamps, std::int64_t origin) {
  return {
      _mm512_cvtepi64_pd(_mm512_sub_epi64(_mm512_loadu_si512(stamps), _mm512_set1_epi64(origin)))};
}

inline Lanes time_difference(const std::int64_t* stamps, const std::int64_t* offsets,
                             std::int64_t origin) {
  const __m512i difference =
      _mm512_sub_epi64(_mm512_loadu_si512(stamps), _mm512_set1_epi64(origin));
  return {_mm512_cvtepi64_pd(_mm512_sub_epi64(difference, _mm512_loadu_si512(offsets)))};
}

inline Lanes larger_magnitude(Lanes a, Lanes b) {
  return {_mm512_max_pd(a.v, _mm512_abs_pd(b.v))};
}

inline Lanes smaller(Lanes a, Lanes b) {
  return {_mm512_min_pd(a.v, b.v)};
}
inline Lanes larger(Lanes a, Lanes b) {
  return {_mm512_max_pd(a.v, b.v)};
}

inline void turn_quadrants(Lanes shifted, Lanes& sine, Lanes& cosine) {
  const __m512i k = _mm512_castpd_si512(shifted.v);
  const __mmask8 odd = _mm512_test_epi64_mask(k, _mm512_set1_epi64(1));
  const __mmask8 upper = _mm512_test_epi64_mask(k, _mm512_set1_epi64(2));
  const __m512d sign = _mm512_set1_pd(-0.0);
  const __m512d s = _mm512_mask_blend_pd(odd, sine.v, cosine.v);
  const __m512d c = _mm512_mask_blend_pd(odd, cosine.v, sine.v);
  sine.v = _mm512_mask_xor_pd(s, upper, s, sign);
  cosine.v = _mm512_mask_xor_pd(c, static_cast<__mmask8>(odd ^ upper), c, sign);
}

struct StepCheck {
  __mmask8 backward = 0;
  void see(const std::int64_t* stamps, const std::int64_t* next) {
    backward = static_cast<__mmask8>(
        backward | _mm512_cmple_epi64_mask(_mm512_loadu_si512(next), _mm512_loadu_si512(stamps)));
  }
  bool increasing() const { return backward == 0; }
};

struct EqualCheck {
  __mmask8 equal = 0;
  void see(Lanes a, Lanes b) {
    equal = static_cast<__mmask8>(equal | _mm512_cmp_pd_mask(a.v, b.v, _CMP_EQ_OQ));
  }
  bool any() const { return equal != 0; }
};

} // namespace

#include "analysis/sine/kernel/sine_kernel_body.hpp"

#include "analysis/sine/kernel/sine_grid_body.hpp"

#include "analysis/sine/kernel/sine_grid_series_body.hpp"

#include "analysis/sine/kernel/sine_model_body.hpp"

#include "analysis/sine/kernel/sine_lines_body.hpp"

namespace dyncal::analysis::kernel {
const SineKernel avx512_kernel{
    "avx512",        fit_on_grid,       series_on_grid,   fit_block,
    design,          design_with_slope, residuals,        residuals_with_slope,
    model_residuals, model_products,    design_with_time, residuals_with_time,
    line_sums,       value_range};
}
