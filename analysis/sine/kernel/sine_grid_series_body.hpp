// Sums weighted with powers of time for the refinement of the frequency, in the fast form of
// sine_grid_body.hpp; included after it.
//
// v is the time from the block's anchor, u that from the origin, in units of the axis. Turning to
// the origin is as there.

// NOLINTBEGIN(misc-definitions-in-headers): every translation unit that includes this has its own,
// without linkage

namespace {

struct alignas(64) GridSeriesBasis {
  double sine[grid_samples];
  double cosine[grid_samples];
  double v[grid_samples];
};

// Lanes of sums weighted with one power of time: of the weight, weight s, weight c, weight cos 2x,
// weight sin 2x.
struct WeightedLanes {
  Lanes one, s, c, cosine_twice, sine_twice;
};

inline Lanes moved(double shift, Lanes lower, Lanes sum) {
  return fused(Lanes::all(shift), lower, sum);
}

// Sums of all blocks so far, time from the origin.
struct SeriesLanes {
  WeightedLanes order[3];

  SeriesLanes() {
    const Lanes zero = Lanes::all(0.0);
    for (WeightedLanes& one : order) {
      one = {zero, zero, zero, zero, zero};
    }
  }

  // A block's own sums, turned, then with (anchor + v)^m for v^m.
  void add(const Anchors& anchors, std::size_t b, double anchor, WeightedLanes (&own)[3]) {
    for (WeightedLanes& one : own) {
      const Lanes zero = Lanes::all(0.0);
      WeightedLanes turned{one.one, zero, zero, zero, zero};
      add_turned(anchors.sine[b], anchors.cosine[b], one.s, one.c, turned.s, turned.c);
      add_turned(anchors.sine_twice[b], anchors.cosine_twice[b], one.sine_twice, one.cosine_twice,
                 turned.sine_twice, turned.cosine_twice);
      one = turned;
    }
    add_moved(anchor, own, [](auto& lanes_of) -> Lanes& { return lanes_of.one; });
    add_moved(anchor, own, [](auto& lanes_of) -> Lanes& { return lanes_of.s; });
    add_moved(anchor, own, [](auto& lanes_of) -> Lanes& { return lanes_of.c; });
    add_moved(anchor, own, [](auto& lanes_of) -> Lanes& { return lanes_of.cosine_twice; });
    add_moved(anchor, own, [](auto& lanes_of) -> Lanes& { return lanes_of.sine_twice; });
  }

  template <class Part>
  void add_moved(double anchor, WeightedLanes (&own)[3], Part part) {
    const Lanes first = moved(anchor, part(own[0]), part(own[1]));
    part(order[0]) = part(order[0]) + part(own[0]);
    part(order[1]) = part(order[1]) + first;
    part(order[2]) = part(order[2]) + moved(anchor, first + part(own[1]), part(own[2]));
  }

  void totals(DesignSums& design, SlopeSums& slope) const {
    double one[3], ss[3], sc[3];
    for (std::size_t m = 0; m < 3; ++m) {
      one[m] = order[m].one.total();
      ss[m] = 0.5 * (one[m] - order[m].cosine_twice.total());
      sc[m] = 0.5 * order[m].sine_twice.total();
    }
    design = {order[0].s.total(), order[0].c.total(), ss[0], sc[0]};
    slope = {one[1], one[2], order[1].s.total(), order[1].c.total(),
             ss[1],  sc[1],  order[2].s.total(), order[2].c.total(),
             ss[2],  sc[2]};
  }
};

// Sine, cosine and time of a block and their sums; false when not all samples are near enough for
// the order.
template <Order order>
inline bool grid_series_design(const std::int64_t* stamps, const GridPlace& place,
                               const TimeAxis& axis, const SampleGrid& grid, GridSeriesBasis& basis,
                               WeightedLanes (&sums)[3]) {
  const std::int64_t* from = stamps + place.first;
  const std::int64_t anchor_ns = stamps[place.anchor()];
  const std::int64_t* offsets_ns = grid.offsets_ns + place.on_grid;
  const double* grid_sine = grid.sine + place.on_grid;
  const double* grid_cosine = grid.cosine + place.on_grid;
  const Lanes scale = Lanes::all(grid.scaled_radians_per_ns);
  const Lanes inverse_scale = Lanes::all(axis.inverse_scale);
  Lanes s = Lanes::all(0.0), c = s, ss = s, sc = s, v1 = s, vs = s, vc = s, vss = s, vsc = s,
        v2 = s, vvs = s, vvc = s, vvss = s, vvsc = s;
  Lanes largest = s;
  for (std::size_t i = 0; i < place.n; i += lanes) {
    prefetch_ahead(from + i);
    const Lanes d = time_difference(from + i, offsets_ns + i, anchor_ns);
    const Lanes v = time_difference(from + i, anchor_ns) * inverse_scale;
    largest = larger_magnitude(largest, d);
    const SineCosine one = turned_from_grid<order>(d * scale, Lanes::load(grid_sine + i),
                                                   Lanes::load(grid_cosine + i));
    one.sine.store(basis.sine + i);
    one.cosine.store(basis.cosine + i);
    v.store(basis.v + i);
    const Lanes v_sine = v * one.sine;
    const Lanes v_cosine = v * one.cosine;
    s = s + one.sine;
    c = c + one.cosine;
    ss = fused(one.sine, one.sine, ss);
    sc = fused(one.sine, one.cosine, sc);
    v1 = v1 + v;
    vs = vs + v_sine;
    vc = vc + v_cosine;
    vss = fused(v_sine, one.sine, vss);
    vsc = fused(v_sine, one.cosine, vsc);
    v2 = fused(v, v, v2);
    vvs = fused(v, v_sine, vvs);
    vvc = fused(v, v_cosine, vvc);
    vvss = fused(v_sine, v_sine, vvss);
    vvsc = fused(v_sine, v_cosine, vvsc);
  }
  const Lanes two = Lanes::all(2.0);
  const std::size_t rows_of_lanes = place.n / lanes;
  const Lanes rows = Lanes::all(static_cast<double>(rows_of_lanes));
  sums[0] = {rows, s, c, fused_less(two, ss, rows), sc + sc};
  sums[1] = {v1, vs, vc, fused_less(two, vss, v1), vsc + vsc};
  sums[2] = {v2, vvs, vvc, fused_less(two, vvss, v2), vvsc + vvsc};
  return largest.all_at_most(order == Order::third ? grid.max_of_third_order_ns : grid.max_ns);
}

struct SeriesResidualLanes {
  Lanes e, es, ec, ee, eus, euc;
};

template <std::size_t count>
inline void grid_series_residuals(const double* const* values, const GridPlace& place,
                                  const Anchors& anchors, std::size_t b, double anchor,
                                  const GridSeriesBasis& basis, const TurnedStart* start,
                                  SeriesResidualLanes* sums) {
  const Lanes zero = Lanes::all(0.0);
  const double* from[count];
  Parameters p[count];
  Lanes e[count], es[count], ec[count], ee[count], evs[count], evc[count];
  for (std::size_t j = 0; j < count; ++j) {
    from[j] = values[j] + place.first;
    p[j] = start[j].of_block(b);
    e[j] = sums[j].e;
    ee[j] = sums[j].ee;
    es[j] = ec[j] = evs[j] = evc[j] = zero;
  }
  for (std::size_t i = 0; i < place.n; i += lanes) {
    const Lanes s = Lanes::load(basis.sine + i);
    const Lanes c = Lanes::load(basis.cosine + i);
    const Lanes v = Lanes::load(basis.v + i);
    for (std::size_t j = 0; j < count; ++j) {
      prefetch_ahead(from[j] + i);
      const Lanes r = StartLanes(p[j]).residual(Lanes::load(from[j] + i), s, c);
      const Lanes rv = r * v;
      e[j] = e[j] + r;
      es[j] = fused(r, s, es[j]);
      ec[j] = fused(r, c, ec[j]);
      ee[j] = fused(r, r, ee[j]);
      evs[j] = fused(rv, s, evs[j]);
      evc[j] = fused(rv, c, evc[j]);
    }
  }
  for (std::size_t j = 0; j < count; ++j) {
    sums[j].e = e[j];
    sums[j].ee = ee[j];
    const Lanes us = moved(anchor, es[j], evs[j]);
    const Lanes uc = moved(anchor, ec[j], evc[j]);
    add_turned(anchors.sine[b], anchors.cosine[b], es[j], ec[j], sums[j].es, sums[j].ec);
    add_turned(anchors.sine[b], anchors.cosine[b], us, uc, sums[j].eus, sums[j].euc);
  }
}

// NOLINTNEXTLINE(readability-function-size): the kernel table calls it with plain pointers
std::size_t series_on_grid(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis,
                           const SampleGrid& grid, const double* const* values,
                           std::size_t channels, const Parameters* start, DesignSums& design,
                           SlopeSums& slope, ResidualSums* residuals,
                           ResidualSlopeSums* residual_slopes) {
  const Anchors anchors = anchors_of(stamps, n, axis);
  const Lanes zero = Lanes::all(0.0);
  SeriesLanes series;
  SeriesResidualLanes sums[grid_call_channels];
  TurnedStart turned[grid_call_channels];
  for (std::size_t j = 0; j < channels; ++j) {
    sums[j] = {zero, zero, zero, zero, zero, zero};
    turned[j].set(anchors, start[j]);
  }
  GridSeriesBasis basis;
  std::size_t taken = 0;
  bool third_order = true; // until a block needs the fifth
  for (std::size_t b = 0; taken < n; ++b) {
    const GridPlace place(b, n);
    WeightedLanes own[3];
    if (third_order) {
      third_order = grid_series_design<Order::third>(stamps, place, axis, grid, basis, own);
    }
    if (!third_order && !grid_series_design<Order::fifth>(stamps, place, axis, grid, basis, own)) {
      break;
    }
    const double anchor =
        static_cast<double>(stamps[place.anchor()] - axis.origin_ns) * axis.inverse_scale;
    series.add(anchors, b, anchor, own);
    std::size_t j = 0;
    if constexpr (Lanes::channels_at_once == 4) {
      for (; j + 2 <= channels; j += 2) {
        grid_series_residuals<2>(values + j, place, anchors, b, anchor, basis, turned + j,
                                 sums + j);
      }
    }
    for (; j < channels; ++j) {
      grid_series_residuals<1>(values + j, place, anchors, b, anchor, basis, turned + j, sums + j);
    }
    taken += place.n;
  }
  series.totals(design, slope);
  for (std::size_t j = 0; j < channels; ++j) {
    residuals[j] = {sums[j].e.total(), sums[j].es.total(), sums[j].ec.total(), sums[j].ee.total()};
    residual_slopes[j] = {sums[j].eus.total(), sums[j].euc.total()};
  }
  return taken;
}

} // namespace

// NOLINTEND(misc-definitions-in-headers)
