// The loops of quadrature_kernel.hpp on vectors of `vector_width` doubles, a definition of each
// source that includes this. Every name here is local to that source: two variants must never share
// a function, or a processor would be given instructions that it has not.

namespace {

using dyncal::analysis::kernel::arctangent_coefficients;
using dyncal::analysis::kernel::arctangent_terms;
using dyncal::analysis::kernel::quadrature_lanes;
using dyncal::analysis::kernel::quadrature_moments;
using dyncal::analysis::kernel::QuadratureCorrection;
using dyncal::analysis::kernel::tangent_of_an_eighth_pi;

inline constexpr std::size_t vector_width = DYNCAL_VECTOR_WIDTH;
using Vector = double __attribute__((vector_size(8 * vector_width)));
using Integers = std::int64_t __attribute__((vector_size(8 * vector_width)));

static_assert(quadrature_lanes % vector_width == 0);

inline Vector all_lanes(double value) {
  return value - Vector{}; // exact, and of either sign of zero
}

inline Vector load_vector(const double* from) {
  Vector result;
  __builtin_memcpy(&result, from, sizeof(result));
  return result;
}

inline void store_vector(double* to, Vector value) {
  __builtin_memcpy(to, &value, sizeof(value));
}

template <class Number>
inline Vector converted(const Number* from) {
  if constexpr (sizeof(Number) == sizeof(double)) {
    return load_vector(from);
  } else if constexpr (sizeof(Number) == sizeof(std::int16_t) && vector_width >= 4) {
    using Shorts = std::int16_t __attribute__((vector_size(2 * vector_width)));
    using Words = std::int32_t __attribute__((vector_size(4 * vector_width)));
    Shorts shorts;
    __builtin_memcpy(&shorts, from, sizeof(shorts));
    return __builtin_convertvector(__builtin_convertvector(shorts, Words), Vector);
  } else if constexpr (sizeof(Number) == sizeof(float)) {
    using Floats = float __attribute__((vector_size(4 * vector_width)));
    Floats floats;
    __builtin_memcpy(&floats, from, sizeof(floats));
    return __builtin_convertvector(floats, Vector);
  } else {
    return Vector{static_cast<double>(from[0]), static_cast<double>(from[1])};
  }
}

inline Integers bits_of(Vector value) {
  return reinterpret_cast<Integers>(value);
}
inline Vector from_bits(Integers bits) {
  return reinterpret_cast<Vector>(bits);
}

// Reduced to the eighth of a turn in which the polynomial holds, then put back by symmetry.
inline Vector arctangent_turns(Vector y, Vector x) {
  const Integers sign = bits_of(all_lanes(-0.0));
  const Vector x_size = from_bits(bits_of(x) & ~sign);
  const Vector y_size = from_bits(bits_of(y) & ~sign);
  const Integers steep = y_size > x_size;
  const Vector smaller = steep ? x_size : y_size;
  const Vector larger = steep ? y_size : x_size;
  const Integers upper = smaller > larger * tangent_of_an_eighth_pi;
  const Vector sum = upper ? smaller + larger : larger;
  const Vector divisor = sum == 0.0 ? all_lanes(1.0) : sum;
  const Vector t = (upper ? smaller - larger : smaller) / divisor;
  const Vector square = t * t;
  Vector polynomial = all_lanes(arctangent_coefficients[arctangent_terms - 1]);
  for (std::size_t k = arctangent_terms - 1; k > 0; --k) {
    polynomial = polynomial * square + arctangent_coefficients[k - 1];
  }
  Vector turns = t * polynomial;
  turns = upper ? turns + 0.125 : turns;
  turns = steep ? 0.25 - turns : turns;
  turns = x < 0.0 ? 0.5 - turns : turns;
  return from_bits(bits_of(turns) | (bits_of(y) & sign));
}

inline void phase_of_vector(Vector u1, Vector u2, const QuadratureCorrection& correction,
                            double* turns, double* radius_squared) {
  const Vector x = u1 - correction.p;
  const Vector y = (u2 - correction.q) * correction.scale + x * correction.tangent;
  store_vector(turns, arctangent_turns(y, x));
  store_vector(radius_squared, x * x + y * y);
}

template <class Number>
void phase_of(const Number* u1, const Number* u2, std::size_t n,
              const QuadratureCorrection& correction, double* turns, double* radius_squared) {
  std::size_t i = 0;
  for (; i + vector_width <= n; i += vector_width) {
    phase_of_vector(converted(u1 + i), converted(u2 + i), correction, turns + i,
                    radius_squared + i);
  }
  if (i == n) {
    return;
  }
  Number rest[2][vector_width] = {};
  double result[2][vector_width];
  for (std::size_t k = 0; i + k < n; ++k) {
    rest[0][k] = u1[i + k];
    rest[1][k] = u2[i + k];
  }
  phase_of_vector(converted(rest[0]), converted(rest[1]), correction, result[0], result[1]);
  for (std::size_t k = 0; i + k < n; ++k) {
    turns[i + k] = result[0][k];
    radius_squared[i + k] = result[1][k];
  }
}

struct LaneSums {
  double lanes[quadrature_lanes] = {};
  double total() const {
    return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) +
           ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
  }
};

inline void moments_of(const double* x, const double* y, std::size_t n, double* sums) {
  LaneSums lanes[quadrature_moments];
  for (std::size_t first = 0; first < quadrature_lanes; first += vector_width) {
    Vector s[quadrature_moments] = {};
    for (std::size_t i = first; i < n; i += quadrature_lanes) {
      const Vector a = load_vector(x + i);
      const Vector b = load_vector(y + i);
      const Vector aa = a * a;
      const Vector ab = a * b;
      const Vector bb = b * b;
      s[0] += a;
      s[1] += b;
      s[2] += aa;
      s[3] += ab;
      s[4] += bb;
      s[5] += aa * a;
      s[6] += aa * b;
      s[7] += a * bb;
      s[8] += bb * b;
      s[9] += aa * aa;
      s[10] += aa * ab;
      s[11] += aa * bb;
      s[12] += ab * bb;
      s[13] += bb * bb;
    }
    for (std::size_t k = 0; k < quadrature_moments; ++k) {
      store_vector(lanes[k].lanes + first, s[k]);
    }
  }
  for (std::size_t k = 0; k < quadrature_moments; ++k) {
    sums[k] += lanes[k].total();
  }
}

inline double fourth_difference_squares_of(const double* x, std::size_t n) {
  LaneSums lanes;
  for (std::size_t first = 0; first < quadrature_lanes; first += vector_width) {
    Vector sum = {};
    for (std::size_t i = first; i < n; i += quadrature_lanes) {
      const Vector outer = load_vector(x + i) + load_vector(x + i + 4);
      const Vector inner = load_vector(x + i + 1) + load_vector(x + i + 3);
      const Vector difference = outer - inner * 4.0 + load_vector(x + i + 2) * 6.0;
      sum += difference * difference;
    }
    store_vector(lanes.lanes + first, sum);
  }
  return lanes.total();
}

inline double sum_of_products_of(const double* a, const double* b, std::size_t n) {
  constexpr std::size_t parts = quadrature_lanes / vector_width;
  Vector sums[parts] = {};
  std::size_t i = 0;
  for (; i + quadrature_lanes <= n; i += quadrature_lanes) {
    for (std::size_t part = 0; part < parts; ++part) {
      const std::size_t at = i + part * vector_width;
      sums[part] += load_vector(a + at) * load_vector(b + at);
    }
  }
  LaneSums lanes;
  for (std::size_t part = 0; part < parts; ++part) {
    store_vector(lanes.lanes + part * vector_width, sums[part]);
  }
  for (std::size_t lane = 0; i + lane < n; ++lane) {
    lanes.lanes[lane] += a[i + lane] * b[i + lane];
  }
  return lanes.total();
}

} // namespace
