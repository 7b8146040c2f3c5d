// Sums of residuals with powers of time and with multiples of a phase, written over the eight lanes
// of sine_kernel_body.hpp and included after it. Sums stay eight lanes wide between calls: adding
// up the lanes is left to the end of a record.

// NOLINTBEGIN(misc-definitions-in-headers): every translation unit that includes this has its own,
// without linkage

namespace {

template <std::size_t count>
struct LaneSums {
  Lanes sums[count];
  double* kept;
  explicit LaneSums(double* from) : kept(from) {
    for (std::size_t k = 0; k < count; ++k) {
      sums[k] = Lanes::load(from + k * lanes);
    }
  }
  void keep() const {
    for (std::size_t k = 0; k < count; ++k) {
      sums[k].store(kept + k * lanes);
    }
  }
};

bool design_with_time(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis,
                      BlockBasis& basis, double* time_sums) {
  const Lanes scale = Lanes::all(axis.inverse_scale);
  LaneSums<design_time_sums> time(time_sums);
  const bool increasing =
      for_each_basis_row(stamps, n, axis, basis, [&](std::size_t i, const SineCosine&, Lanes dt) {
        const Lanes u = dt * scale;
        u.store(basis.u + i);
        Lanes power = u;
        for (std::size_t m = 0; m < design_time_sums; ++m) {
          time.sums[m] = time.sums[m] + power;
          power = power * u;
        }
      });
  time.keep();
  return increasing;
}

void residuals_with_time(const double* values, std::size_t n, const BlockBasis& basis,
                         const Parameters& start, double* residuals, double* sums) {
  LaneSums<residual_time_sums> all(sums);
  for_each_residual_row(values, n, basis, start, [&](std::size_t i, Lanes e, Lanes, Lanes) {
    const Lanes u = Lanes::load(basis.u + i);
    const Lanes eu = e * u;
    const Lanes euu = eu * u;
    e.store(residuals + i);
    all.sums[0] = all.sums[0] + e;
    all.sums[1] = all.sums[1] + eu;
    all.sums[2] = all.sums[2] + euu;
    all.sums[3] = fused(euu, u, all.sums[3]);
    all.sums[4] = fused(e, e, all.sums[4]);
  });
  all.keep();
}

constexpr std::size_t wave_rows = 16; // of a part of a block whose waves stay in the nearest cache
constexpr std::size_t orders_at_once = 3;

struct Waves {
  Lanes sine[wave_rows], cosine[wave_rows];
};

// Sine and cosine of a multiple of the phase, and of the multiple one higher than `from`.
struct WaveRow {
  Lanes sine, cosine;
};
inline WaveRow next_order(const WaveRow& first, const WaveRow& from) {
  return {fused(from.sine, first.cosine, from.cosine * first.sine),
          fused_less(from.sine, first.sine, from.cosine * first.cosine)};
}

inline void add_design(const WaveRow& wave, Lanes* sums) {
  sums[0] = sums[0] + wave.sine;
  sums[1] = sums[1] + wave.cosine;
  sums[2] = fused(wave.sine, wave.sine, sums[2]);
  sums[3] = fused(wave.sine, wave.cosine, sums[3]);
}

// The next orders from the one in `before`, which is then the last of them. With `from_first` the
// first of them is the phase itself.
template <bool from_first>
inline void next_orders(const Waves& first, Waves& before, std::size_t rows, Waves* waves,
                        double* design) {
  LaneSums<orders_at_once * line_design_sums> all(design);
  for (std::size_t r = 0; r < rows; ++r) {
    const WaveRow one{first.sine[r], first.cosine[r]};
    WaveRow wave{before.sine[r], before.cosine[r]};
    for (std::size_t k = 0; k < orders_at_once; ++k) {
      if (!from_first || k > 0) {
        wave = next_order(one, wave);
      }
      add_design(wave, all.sums + k * line_design_sums);
      waves[k].sine[r] = wave.sine;
      waves[k].cosine[r] = wave.cosine;
    }
    before.sine[r] = wave.sine;
    before.cosine[r] = wave.cosine;
  }
  all.keep();
}

inline void add_products(const double* residuals, const Waves* waves, std::size_t rows,
                         double* sums) {
  LaneSums<2 * orders_at_once> all(sums);
  for (std::size_t r = 0; r < rows; ++r) {
    const Lanes e = Lanes::load(residuals + r * lanes);
    for (std::size_t k = 0; k < orders_at_once; ++k) {
      all.sums[2 * k] = fused(e, waves[k].sine[r], all.sums[2 * k]);
      all.sums[2 * k + 1] = fused(e, waves[k].cosine[r], all.sums[2 * k + 1]);
    }
  }
  all.keep();
}

void line_sums(const BlockBasis& basis, std::size_t n, std::size_t first_order, std::size_t orders,
               const double* const* residuals, std::size_t channels, double* design,
               double* const* sums) {
  Waves first, before, waves[orders_at_once];
  for (std::size_t i = 0; i < n; i += wave_rows * lanes) {
    const std::size_t left = (n - i + lanes - 1) / lanes;
    const std::size_t rows = left < wave_rows ? left : wave_rows;
    for (std::size_t r = 0; r < rows; ++r) {
      WaveRow wave{Lanes::load(basis.sine + i + r * lanes),
                   Lanes::load(basis.cosine + i + r * lanes)};
      first.sine[r] = wave.sine;
      first.cosine[r] = wave.cosine;
      for (std::size_t order = 2; order < first_order; ++order) {
        wave = next_order({first.sine[r], first.cosine[r]}, wave);
      }
      before.sine[r] = wave.sine;
      before.cosine[r] = wave.cosine;
    }
    for (std::size_t k = 0; k < orders; k += orders_at_once) {
      double* const design_of_orders = design + k * line_design_sums * lanes;
      if (k == 0 && first_order == 1) {
        next_orders<true>(first, before, rows, waves, design_of_orders);
      } else {
        next_orders<false>(first, before, rows, waves, design_of_orders);
      }
      for (std::size_t j = 0; j < channels; ++j) {
        add_products(residuals[j] + i, waves, rows, sums[j] + 2 * k * lanes);
      }
    }
  }
}

bool value_range(const double* values, std::size_t n, double& low, double& high) {
  const std::size_t full = full_groups(n);
  Lanes smallest = Lanes::all(values[0]), largest = smallest;
  EqualCheck equal;
  for (std::size_t i = 0; i < full; i += lanes) {
    const Lanes y = Lanes::load(values + i);
    smallest = smaller(smallest, y);
    largest = larger(largest, y);
    equal.see(y, Lanes::load(values + i + 1));
  }
  low = smallest.minimum();
  high = largest.maximum();
  bool any = equal.any();
  for (std::size_t i = full; i < n; ++i) {
    low = values[i] < low ? values[i] : low;
    high = values[i] > high ? values[i] : high;
    any = any || (i + 1 < n && values[i] == values[i + 1]);
  }
  return any;
}

} // namespace

// NOLINTEND(misc-definitions-in-headers)
