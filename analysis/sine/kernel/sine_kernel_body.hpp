// The loops of sine_kernel.hpp, written once over a type of eight lanes. Each translation unit that
// includes this file is compiled for one instruction set and defines `Lanes` in an unnamed
// namespace before; nothing here has external linkage and nothing of the standard library is
// instantiated, so that no wide instruction leaks into shared inline functions.
//
// Lanes provides: load, store, all(value), mask(count), operators + - * &, fused(a,b,c) = a b + c,
// fused_less(a,b,c) = c - a b, fused_minus(a,b,c) = a b - c, time_difference(stamps, origin),
// turn_quadrants(k, s, c), total(), and StepCheck with see(stamps, next) and increasing().

// NOLINTBEGIN(misc-definitions-in-headers): every translation unit that includes this has its own,
// without linkage

namespace {

using namespace dyncal::analysis::kernel;

struct SineCosine {
  Lanes sine, cosine;
};

inline SineCosine sine_cosine_of_time(Lanes dt, Lanes high, Lanes low) {
  const Lanes product = dt * high;
  const Lanes rest = fused(dt, low, fused_minus(dt, high, product));
  const Lanes shifted = fused(product, Lanes::all(4.0), Lanes::all(rounding_shift));
  const Lanes quarters = shifted - Lanes::all(rounding_shift);
  const Lanes r = fused_less(quarters, Lanes::all(0.25), product) + rest;
  const Lanes z = r * r;
  Lanes s = Lanes::all(sine_coefficients[6]);
  Lanes c = Lanes::all(cosine_coefficients[6]);
  for (int i = 5; i >= 0; --i) {
    s = fused(s, z, Lanes::all(sine_coefficients[i]));
    c = fused(c, z, Lanes::all(cosine_coefficients[i]));
  }
  SineCosine result{s * r, fused(c, z, Lanes::all(1.0))};
  turn_quadrants(shifted, result.sine, result.cosine);
  return result;
}

// The last one to eight samples of a block, padded: rows past the end are masked to zero.
struct StampTail {
  std::int64_t stamps[2 * lanes];
  StampTail(const std::int64_t* from, std::size_t count) {
    for (std::size_t i = 0; i < 2 * lanes; ++i) {
      stamps[i] = i < count ? from[i] : from[count - 1] + static_cast<std::int64_t>(i - count + 1);
    }
  }
};
struct ValueTail {
  double values[lanes];
  ValueTail(const double* from, std::size_t count) {
    for (std::size_t i = 0; i < lanes; ++i) {
      values[i] = i < count ? from[i] : 0.0;
    }
  }
};

inline std::size_t full_groups(std::size_t n) {
  return (n - 1) / lanes * lanes;
}

// Eight samples that all belong to the block, or its last ones.
struct AllOfRow {};
struct PartOfRow {
  std::size_t count;
};
inline Lanes load_row(const double* values, AllOfRow) {
  return Lanes::load(values);
}
inline Lanes load_row(const double* values, PartOfRow part) {
  return Lanes::load(ValueTail(values, part.count).values);
}
inline Lanes masked(Lanes x, AllOfRow) {
  return x;
}
inline Lanes masked(Lanes x, PartOfRow part) {
  return x & Lanes::mask(part.count);
}

// Calls row(first index, sine and cosine of eight samples, dt, AllOfRow or PartOfRow) for every
// eight samples.
template <class Row>
inline bool for_each_time_row(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis,
                              Row row) {
  const Lanes high = Lanes::all(axis.turns_per_ns_high);
  const Lanes low = Lanes::all(axis.turns_per_ns_low);
  const std::size_t full = full_groups(n);
  StepCheck steps;
  for (std::size_t i = 0; i < full; i += lanes) {
    const Lanes dt = time_difference(stamps + i, axis.origin_ns);
    steps.see(stamps + i, stamps + i + 1);
    row(i, sine_cosine_of_time(dt, high, low), dt, AllOfRow{});
  }
  const PartOfRow part{n - full};
  const StampTail tail(stamps + full, part.count);
  const Lanes dt = time_difference(tail.stamps, axis.origin_ns);
  steps.see(tail.stamps, tail.stamps + 1);
  const SineCosine last = sine_cosine_of_time(dt, high, low);
  row(full, SineCosine{masked(last.sine, part), masked(last.cosine, part)}, masked(dt, part), part);
  return steps.increasing();
}

// The same, after storing sine and cosine.
template <class Row>
inline bool for_each_basis_row(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis,
                               BlockBasis& basis, Row row) {
  return for_each_time_row(stamps, n, axis,
                           [&](std::size_t i, const SineCosine& sc, Lanes dt, auto) {
                             sc.sine.store(basis.sine + i);
                             sc.cosine.store(basis.cosine + i);
                             row(i, sc, dt);
                           });
}

// `also` is called with the first index of every row.
template <class Also>
inline bool design_and(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis,
                       BlockBasis& basis, DesignSums& sums, Also also) {
  Lanes s = Lanes::all(0.0), c = s, ss = s, sc = s;
  const bool increasing =
      for_each_basis_row(stamps, n, axis, basis, [&](std::size_t i, const SineCosine& row, Lanes) {
        also(i);
        s = s + row.sine;
        c = c + row.cosine;
        ss = fused(row.sine, row.sine, ss);
        sc = fused(row.sine, row.cosine, sc);
      });
  sums = {s.total(), c.total(), ss.total(), sc.total()};
  return increasing;
}

bool design(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis, BlockBasis& basis,
            DesignSums& sums) {
  return design_and(stamps, n, axis, basis, sums, [](std::size_t) {});
}

bool design_with_slope(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis,
                       BlockBasis& basis, DesignSums& sums, SlopeSums& slope) {
  const Lanes scale = Lanes::all(axis.inverse_scale);
  Lanes s = Lanes::all(0.0), c = s, ss = s, sc = s;
  Lanes u1 = s, u2 = s, us = s, uc = s;
  const bool increasing = for_each_basis_row(stamps, n, axis, basis,
                                             [&](std::size_t i, const SineCosine& row, Lanes dt) {
                                               const Lanes u = dt * scale;
                                               u.store(basis.u + i);
                                               s = s + row.sine;
                                               c = c + row.cosine;
                                               ss = fused(row.sine, row.sine, ss);
                                               sc = fused(row.sine, row.cosine, sc);
                                               u1 = u1 + u;
                                               u2 = fused(u, u, u2);
                                               us = fused(u, row.sine, us);
                                               uc = fused(u, row.cosine, uc);
                                             });
  sums = {s.total(), c.total(), ss.total(), sc.total()};
  Lanes uss = Lanes::all(0.0), usc = uss, uus = uss, uuc = uss, uuss = uss, uusc = uss;
  for (std::size_t i = 0; i < n; i += lanes) {
    const Lanes u = Lanes::load(basis.u + i);
    const Lanes us_i = u * Lanes::load(basis.sine + i);
    const Lanes uc_i = u * Lanes::load(basis.cosine + i);
    uss = fused(us_i, Lanes::load(basis.sine + i), uss);
    usc = fused(us_i, Lanes::load(basis.cosine + i), usc);
    uus = fused(us_i, u, uus);
    uuc = fused(uc_i, u, uuc);
    uuss = fused(us_i, us_i, uuss);
    uusc = fused(us_i, uc_i, uusc);
  }
  slope = {u1.total(),  u2.total(),  us.total(),  uc.total(),   uss.total(),
           usc.total(), uus.total(), uuc.total(), uuss.total(), uusc.total()};
  return increasing;
}

struct StartLanes {
  Lanes sine, cosine, offset;
  explicit StartLanes(const Parameters& p)
      : sine(Lanes::all(p.sine)), cosine(Lanes::all(p.cosine)), offset(Lanes::all(p.offset)) {}
  Lanes residual(Lanes y, Lanes s, Lanes c) const {
    return fused_less(sine, s, fused_less(cosine, c, y - offset));
  }
};

// Calls row(i, e, s, c) for every eight samples of a channel.
template <class Row>
inline void for_each_residual_row(const double* values, std::size_t n, const BlockBasis& basis,
                                  const Parameters& start, Row row) {
  const StartLanes model(start);
  const std::size_t full = full_groups(n);
  for (std::size_t i = 0; i < full; i += lanes) {
    const Lanes s = Lanes::load(basis.sine + i);
    const Lanes c = Lanes::load(basis.cosine + i);
    row(i, model.residual(Lanes::load(values + i), s, c), s, c);
  }
  const ValueTail tail(values + full, n - full);
  const Lanes s = Lanes::load(basis.sine + full);
  const Lanes c = Lanes::load(basis.cosine + full);
  row(full, model.residual(Lanes::load(tail.values), s, c) & Lanes::mask(n - full), s, c);
}

void residuals(const double* values, std::size_t n, const BlockBasis& basis,
               const Parameters& start, ResidualSums& sums) {
  Lanes sum = Lanes::all(0.0), es = sum, ec = sum, ee = sum;
  for_each_residual_row(values, n, basis, start, [&](std::size_t, Lanes e, Lanes s, Lanes c) {
    sum = sum + e;
    es = fused(e, s, es);
    ec = fused(e, c, ec);
    ee = fused(e, e, ee);
  });
  sums = {sum.total(), es.total(), ec.total(), ee.total()};
}

// Residuals of several channels in one go: the basis is loaded once.
template <std::size_t count>
inline void residuals_of(const double* const* values, std::size_t n, const BlockBasis& basis,
                         const Parameters* start, ResidualSums* sums) {
  const Lanes zero = Lanes::all(0.0);
  Lanes e[count], es[count], ec[count], ee[count];
  for (std::size_t j = 0; j < count; ++j) {
    e[j] = es[j] = ec[j] = ee[j] = zero;
  }
  const auto row = [&](std::size_t i, auto rows) {
    const Lanes s = Lanes::load(basis.sine + i);
    const Lanes c = Lanes::load(basis.cosine + i);
    for (std::size_t j = 0; j < count; ++j) {
      const Lanes r =
          masked(StartLanes(start[j]).residual(load_row(values[j] + i, rows), s, c), rows);
      e[j] = e[j] + r;
      es[j] = fused(r, s, es[j]);
      ec[j] = fused(r, c, ec[j]);
      ee[j] = fused(r, r, ee[j]);
    }
  };
  const std::size_t full = full_groups(n);
  for (std::size_t i = 0; i < full; i += lanes) {
    row(i, AllOfRow{});
  }
  row(full, PartOfRow{n - full});
  for (std::size_t j = 0; j < count; ++j) {
    sums[j] = {e[j].total(), es[j].total(), ec[j].total(), ee[j].total()};
  }
}

bool fit_block(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis,
               const double* const* values, std::size_t channels, const Parameters* start,
               DesignSums& sums, ResidualSums* residual_sums) {
  BlockBasis basis;
  // While the sines are computed, the values come from memory.
  const bool increasing = design_and(stamps, n, axis, basis, sums, [&](std::size_t i) {
    for (std::size_t j = 0; j < channels; ++j) {
      __builtin_prefetch(values[j] + i);
    }
  });
  std::size_t j = 0;
  for (; j + 2 <= channels; j += 2) {
    residuals_of<2>(values + j, n, basis, start + j, residual_sums + j);
  }
  for (; j < channels; ++j) {
    residuals_of<1>(values + j, n, basis, start + j, residual_sums + j);
  }
  return increasing;
}

void residuals_with_slope(const double* values, std::size_t n, const BlockBasis& basis,
                          const Parameters& start, ResidualSums& sums, ResidualSlopeSums& slope) {
  Lanes sum = Lanes::all(0.0), es = sum, ec = sum, ee = sum, eus = sum, euc = sum;
  for_each_residual_row(values, n, basis, start, [&](std::size_t i, Lanes e, Lanes s, Lanes c) {
    const Lanes eu = e * Lanes::load(basis.u + i);
    sum = sum + e;
    es = fused(e, s, es);
    ec = fused(e, c, ec);
    ee = fused(e, e, ee);
    eus = fused(eu, s, eus);
    euc = fused(eu, c, euc);
  });
  sums = {sum.total(), es.total(), ec.total(), ee.total()};
  slope = {eus.total(), euc.total()};
}

} // namespace

// NOLINTEND(misc-definitions-in-headers)
