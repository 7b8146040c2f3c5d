// For every processor: two lanes a register (SSE2, NEON), and the fused multiply-add composed when
// there is none.
#include "analysis/sine/kernel/sine_kernel.hpp"
#include "analysis/sine/kernel/sine_polynomial.hpp"

#include "analysis/sine/kernel/composed_fma.hpp"

namespace {

using dyncal::analysis::kernel::Bits2;
using dyncal::analysis::kernel::Double2;

struct Lanes {
  Double2 v[4];
  static constexpr std::size_t channels_at_once = 1;

  static Lanes all(double value) {
    const Double2 two = {value, value};
    return {{two, two, two, two}};
  }
  static Lanes load(const double* from) {
    Lanes result;
    __builtin_memcpy(&result, from, sizeof(result));
    return result;
  }
  static Lanes mask(std::size_t count) {
    std::int64_t bits[8];
    for (std::size_t i = 0; i < 8; ++i) {
      bits[i] = i < count ? -1 : 0;
    }
    Lanes result;
    __builtin_memcpy(&result, bits, sizeof(result));
    return result;
  }
  void store(double* to) const { __builtin_memcpy(to, this, sizeof(*this)); }

  bool all_at_most(double limit) const {
    bool all = true;
    for (const Double2 two : v) {
      all &= two[0] <= limit && two[1] <= limit;
    }
    return all;
  }

  double total() const {
    return ((v[0][0] + v[0][1]) + (v[1][0] + v[1][1])) +
           ((v[2][0] + v[2][1]) + (v[3][0] + v[3][1]));
  }

  double minimum() const {
    const auto least = [](Double2 x, Double2 y) { return x < y ? x : y; };
    const Double2 two = least(least(v[0], v[1]), least(v[2], v[3]));
    return two[0] < two[1] ? two[0] : two[1];
  }
  double maximum() const {
    const auto most = [](Double2 x, Double2 y) { return x > y ? x : y; };
    const Double2 two = most(most(v[0], v[1]), most(v[2], v[3]));
    return two[0] > two[1] ? two[0] : two[1];
  }
};

template <class Operation>
inline Lanes each(Operation operation) {
  return {{operation(0), operation(1), operation(2), operation(3)}};
}

inline Lanes operator+(const Lanes& x, const Lanes& y) {
  return each([&](int i) { return x.v[i] + y.v[i]; });
}
inline Lanes operator-(const Lanes& x, const Lanes& y) {
  return each([&](int i) { return x.v[i] - y.v[i]; });
}
inline Lanes operator*(const Lanes& x, const Lanes& y) {
  return each([&](int i) { return x.v[i] * y.v[i]; });
}
inline Double2 from_bits(Bits2 bits) {
  return reinterpret_cast<Double2>(bits);
}
inline Bits2 to_bits(Double2 value) {
  return reinterpret_cast<Bits2>(value);
}
inline Lanes operator&(const Lanes& x, const Lanes& y) {
  return each([&](int i) { return from_bits(to_bits(x.v[i]) & to_bits(y.v[i])); });
}

inline Double2 fused_two(Double2 a, Double2 b, Double2 c) {
#ifdef __FP_FAST_FMA
  return Double2{__builtin_fma(a[0], b[0], c[0]), __builtin_fma(a[1], b[1], c[1])};
#else
  return dyncal::analysis::kernel::composed_fma(a, b, c);
#endif
}
inline Lanes fused(const Lanes& x, const Lanes& y, const Lanes& z) {
  return each([&](int i) { return fused_two(x.v[i], y.v[i], z.v[i]); });
}
inline Lanes fused_less(const Lanes& x, const Lanes& y, const Lanes& z) {
  return each([&](int i) { return fused_two(-x.v[i], y.v[i], z.v[i]); });
}
inline Lanes fused_minus(const Lanes& x, const Lanes& y, const Lanes& z) {
  return each([&](int i) { return fused_two(x.v[i], y.v[i], -z.v[i]); });
}

inline Lanes time_difference(const std::int64_t* stamps, std::int64_t origin) {
  return each([&](std::ptrdiff_t i) {
    return Double2{static_cast<double>(stamps[2 * i] - origin),
                   static_cast<double>(stamps[2 * i + 1] - origin)};
  });
}

inline Lanes time_difference(const std::int64_t* stamps, const std::int64_t* offsets,
                             std::int64_t origin) {
  const auto one = [&](int i) { return static_cast<double>(stamps[i] - origin - offsets[i]); };
  return each([&](int i) { return Double2{one(2 * i), one(2 * i + 1)}; });
}

inline Lanes larger_magnitude(const Lanes& x, const Lanes& y) {
  const auto larger = [](double a, double b) {
    return __builtin_fmax(__builtin_fabs(a), __builtin_fabs(b));
  };
  return each([&](int i) {
    return Double2{larger(x.v[i][0], y.v[i][0]), larger(x.v[i][1], y.v[i][1])};
  });
}

inline Lanes smaller(const Lanes& x, const Lanes& y) {
  return each([&](int i) { return x.v[i] < y.v[i] ? x.v[i] : y.v[i]; });
}
inline Lanes larger(const Lanes& x, const Lanes& y) {
  return each([&](int i) { return x.v[i] > y.v[i] ? x.v[i] : y.v[i]; });
}

inline void turn_quadrants(const Lanes& shifted, Lanes& sine, Lanes& cosine) {
  for (int i = 0; i < 4; ++i) {
    const Bits2 k = to_bits(shifted.v[i]);
    const Bits2 one = {1, 1};
    const Bits2 odd = (k & one) == one;
    const Bits2 s = (to_bits(sine.v[i]) & ~odd) | (to_bits(cosine.v[i]) & odd);
    const Bits2 c = (to_bits(cosine.v[i]) & ~odd) | (to_bits(sine.v[i]) & odd);
    sine.v[i] = from_bits(s ^ ((k >> 1) << 63));
    cosine.v[i] = from_bits(c ^ (((k >> 1) ^ k) << 63));
  }
}

struct StepCheck {
  bool all_increase = true;
  void see(const std::int64_t* stamps, const std::int64_t* next) {
    for (std::size_t i = 0; i < dyncal::analysis::kernel::lanes; ++i) {
      all_increase &= next[i] > stamps[i];
    }
  }
  bool increasing() const { return all_increase; }
};

struct EqualCheck {
  Bits2 equal = {0, 0};
  void see(const Lanes& x, const Lanes& y) {
    for (int i = 0; i < 4; ++i) {
      equal |= x.v[i] == y.v[i];
    }
  }
  bool any() const { return (equal[0] | equal[1]) != 0; }
};

} // namespace

#include "analysis/sine/kernel/sine_kernel_body.hpp"

#include "analysis/sine/kernel/sine_grid_body.hpp"

#include "analysis/sine/kernel/sine_grid_series_body.hpp"

#include "analysis/sine/kernel/sine_model_body.hpp"

#include "analysis/sine/kernel/sine_lines_body.hpp"

namespace dyncal::analysis::kernel {
const SineKernel baseline_kernel{
    "baseline",      fit_on_grid,       series_on_grid,   fit_block,
    design,          design_with_slope, residuals,        residuals_with_slope,
    model_residuals, model_products,    design_with_time, residuals_with_time,
    line_sums,       value_range};
}
