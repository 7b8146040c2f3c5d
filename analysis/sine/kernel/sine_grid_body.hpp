// The fast form of the fit for nearly equidistant samples (sine_grid.hpp), written over the eight
// lanes of sine_kernel_body.hpp and included after it.
//
// Every block is summed in coordinates of its own, phases about its anchor, where sine and cosine
// are the grid's plus a small turn; the lanes of its sums are then turned to the common origin by
// the anchor's phase, which is reduced exactly. Of the design, the lanes keep sums of cos 2x = 1 -
// 2 s^2 and of sin 2x = 2 s c, which turn by the doubled phase.

// NOLINTBEGIN(misc-definitions-in-headers): every translation unit that includes this has its own,
// without linkage

namespace {

// Of the polynomials by which sine and cosine follow from the grid's.
enum class Order { third, fifth };

struct alignas(64) GridBasis {
  double sine[grid_samples];
  double cosine[grid_samples];
};

struct Anchors { // of the blocks of one call, a lane each
  double sine[lanes], cosine[lanes];
  double sine_twice[lanes], cosine_twice[lanes];
};

// Sums of one block or of all of them, a lane for every eighth sample.
struct GridDesignLanes {
  Lanes s, c, cosine_twice, sine_twice;
};
struct GridResidualLanes {
  Lanes e, es, ec, ee;
};

// Where a block lies in the samples of a call and on the grid: a shorter one lies about the middle
// of the grid.
struct GridPlace {
  std::size_t first, n, on_grid;
  GridPlace(std::size_t block, std::size_t samples)
      : first(block * grid_samples),
        n(samples - first < grid_samples ? samples - first : grid_samples),
        on_grid((grid_samples - n) / 2) {}
  [[nodiscard]] std::size_t anchor() const { return first + grid_samples / 2 - on_grid; }
};

// Into the second-level cache: the processor follows one stream by itself, not one more for every
// channel; and more reads can be under way there than towards the first level.
template <class Number>
inline void prefetch_ahead(const Number* at) {
  __builtin_prefetch(at + fetched_ahead_samples, 0, 2);
}

// sin x and 1 - cos x of a small angle x = sqrt(2) scaled: what is x^2 / 2 need not be multiplied
// out.
template <Order order>
inline SineCosine small_turn(Lanes scaled) {
  constexpr double root = 1.4142135623730951;
  const Lanes z = scaled * scaled; // x^2 / 2
  if constexpr (order == Order::third) {
    return {scaled * fused_less(z, Lanes::all(root / 3.0), Lanes::all(root)), z};
  } else {
    const Lanes sine = fused_less(z, fused_less(z, Lanes::all(root / 30.0), Lanes::all(root / 3.0)),
                                  Lanes::all(root));
    return {scaled * sine, fused_less(z * z, Lanes::all(1.0 / 6.0), z)};
  }
}

// Sine and cosine of a sample from those of the grid.
template <Order order>
inline SineCosine turned_from_grid(Lanes scaled, Lanes s0, Lanes c0) {
  const SineCosine turn = small_turn<order>(scaled);
  return {s0 + fused_less(s0, turn.cosine, c0 * turn.sine),
          c0 - fused(c0, turn.cosine, s0 * turn.sine)};
}

// Sine and cosine of a block's samples.
template <Order order>
class GridTurns {
public:
  GridTurns(const std::int64_t* stamps, const GridPlace& place, const SampleGrid& grid)
      : from_(stamps + place.first), offsets_ns_(grid.offsets_ns + place.on_grid),
        sine_(grid.sine + place.on_grid), cosine_(grid.cosine + place.on_grid),
        anchor_ns_(stamps[place.anchor()]), scale_(Lanes::all(grid.scaled_radians_per_ns)),
        largest_(Lanes::all(0.0)),
        limit_ns_(order == Order::third ? grid.max_of_third_order_ns : grid.max_ns) {}

  SineCosine at(std::size_t i) {
    prefetch_ahead(from_ + i);
    const Lanes d = time_difference(from_ + i, offsets_ns_ + i, anchor_ns_);
    largest_ = larger_magnitude(largest_, d);
    return turned_from_grid<order>(d * scale_, Lanes::load(sine_ + i), Lanes::load(cosine_ + i));
  }
  // Whether all samples were near enough for the order.
  [[nodiscard]] bool right() const { return largest_.all_at_most(limit_ns_); }

private:
  const std::int64_t* from_;
  const std::int64_t* offsets_ns_;
  const double* sine_;
  const double* cosine_;
  std::int64_t anchor_ns_;
  Lanes scale_;
  Lanes largest_;
  double limit_ns_;
};

struct GridDesign { // of one block
  Lanes s = Lanes::all(0.0), c = s, ss = s, sc = s;

  void add(const SineCosine& one) {
    s = s + one.sine;
    c = c + one.cosine;
    ss = fused(one.sine, one.sine, ss);
    sc = fused(one.sine, one.cosine, sc);
  }
  [[nodiscard]] GridDesignLanes sums(const GridPlace& place) const {
    const std::size_t rows_of_lanes = place.n / lanes;
    const Lanes rows = Lanes::all(static_cast<double>(rows_of_lanes));
    return {s, c, fused_less(Lanes::all(2.0), ss, rows), sc + sc};
  }
};

// `count` channels at once: e and ee of all blocks so far, es and ec of this one. Without a start
// value for sine and cosine their product with the basis is left out.
template <std::size_t count, bool about_start>
class GridResiduals {
public:
  GridResiduals(const double* const* values, const GridPlace& place, const Parameters* start,
                const GridResidualLanes* sums) {
    for (std::size_t j = 0; j < count; ++j) {
      from_[j] = values[j] + place.first;
      start_[j] = start[j];
      e_[j] = sums[j].e;
      ee_[j] = sums[j].ee;
      es_[j] = ec_[j] = Lanes::all(0.0);
    }
  }
  void add(std::size_t i, std::size_t j, Lanes s, Lanes c) {
    Lanes r = Lanes::load(from_[j] + i) - Lanes::all(start_[j].offset);
    if constexpr (about_start) {
      r = fused_less(Lanes::all(start_[j].sine), s, fused_less(Lanes::all(start_[j].cosine), c, r));
    }
    e_[j] = e_[j] + r;
    es_[j] = fused(r, s, es_[j]);
    ec_[j] = fused(r, c, ec_[j]);
    ee_[j] = fused(r, r, ee_[j]);
  }
  void prefetch(std::size_t i, std::size_t j) const { prefetch_ahead(from_[j] + i); }
  void store(GridResidualLanes* sums) const {
    for (std::size_t j = 0; j < count; ++j) {
      sums[j] = {e_[j], es_[j], ec_[j], ee_[j]};
    }
  }

private:
  const double* from_[count];
  Parameters start_[count];
  Lanes e_[count], es_[count], ec_[count], ee_[count];
};

// Everything in one pass over the samples, for processors whose registers hold the sums of four
// channels beside the sine. False when not all samples are near enough for the order; then nothing
// was added.
template <Order order>
inline bool grid_block_of_four(const std::int64_t* stamps, const GridPlace& place,
                               const SampleGrid& grid, const double* const* values,
                               const Parameters* start, GridDesignLanes& design_sums,
                               GridResidualLanes* sums) {
  GridTurns<order> turns(stamps, place, grid);
  GridDesign design;
  GridResiduals<4, false> residuals(values, place, start, sums);
  for (std::size_t i = 0; i < place.n; i += lanes) {
    const SineCosine one = turns.at(i);
    design.add(one);
    for (std::size_t j = 0; j < 4; ++j) {
      residuals.prefetch(i, j);
      residuals.add(i, j, one.sine, one.cosine);
    }
  }
  if (!turns.right()) {
    return false;
  }
  design_sums = design.sums(place);
  residuals.store(sums);
  return true;
}

// Sine and cosine of a block and their sums; false when not all samples are near enough for the
// order.
template <Order order>
inline bool grid_design(const std::int64_t* stamps, const GridPlace& place, const SampleGrid& grid,
                        const double* const* values, std::size_t channels, GridBasis& basis,
                        GridDesignLanes& sums) {
  const double* channel_0 = values[0] + place.first;
  const double* channel_2 = values[channels > 2 ? 2 : 0] + place.first;
  GridTurns<order> turns(stamps, place, grid);
  GridDesign design;
  for (std::size_t i = 0; i < place.n; i += lanes) {
    prefetch_ahead(channel_0 + i);
    prefetch_ahead(channel_2 + i);
    const SineCosine one = turns.at(i);
    one.sine.store(basis.sine + i);
    one.cosine.store(basis.cosine + i);
    design.add(one);
  }
  sums = design.sums(place);
  return turns.right();
}

template <std::size_t count, bool about_start>
inline void grid_residuals(const double* const* values, const GridPlace& place,
                           const GridBasis& basis, const Parameters* start,
                           GridResidualLanes* sums) {
  GridResiduals<count, about_start> residuals(values, place, start, sums);
  for (std::size_t i = 0; i < place.n; i += lanes) {
    const Lanes s = Lanes::load(basis.sine + i);
    const Lanes c = Lanes::load(basis.cosine + i);
    for (std::size_t j = 0; j < count; ++j) {
      if (j % 2 == 1) {
        residuals.prefetch(i, j);
      }
      residuals.add(i, j, s, c);
    }
  }
  residuals.store(sums);
}

template <bool about_start>
inline void all_grid_residuals(const double* const* values, std::size_t channels,
                               const GridPlace& place, const GridBasis& basis,
                               const Parameters* start, GridResidualLanes* sums) {
  std::size_t j = 0;
  if constexpr (Lanes::channels_at_once == 4) {
    for (; j + 4 <= channels; j += 4) {
      grid_residuals<4, about_start>(values + j, place, basis, start + j, sums + j);
    }
    for (; j + 2 <= channels; j += 2) {
      grid_residuals<2, about_start>(values + j, place, basis, start + j, sums + j);
    }
  }
  for (; j < channels; ++j) {
    grid_residuals<1, about_start>(values + j, place, basis, start + j, sums + j);
  }
}

inline Anchors anchors_of(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis) {
  std::int64_t anchors_ns[lanes];
  for (std::size_t b = 0; b < lanes; ++b) {
    anchors_ns[b] = stamps[b * grid_samples < n ? GridPlace(b, n).anchor() : 0];
  }
  const Lanes dt = time_difference(anchors_ns, axis.origin_ns);
  const SineCosine turn = sine_cosine_of_time(dt, Lanes::all(axis.turns_per_ns_high),
                                              Lanes::all(axis.turns_per_ns_low));
  Anchors anchors;
  turn.sine.store(anchors.sine);
  turn.cosine.store(anchors.cosine);
  const Lanes twice = turn.sine + turn.sine;
  (twice * turn.cosine).store(anchors.sine_twice);
  fused_less(twice, turn.sine, Lanes::all(1.0)).store(anchors.cosine_twice);
  return anchors;
}

// Start values of a channel about the anchors of all blocks. By lanes too: GCC 12 contracts pairs
// of scalar sums and differences of products even when told not to.
struct TurnedStart {
  double sine[lanes], cosine[lanes], offset;

  void set(const Anchors& anchors, const Parameters& p) {
    const Lanes s = Lanes::load(anchors.sine);
    const Lanes c = Lanes::load(anchors.cosine);
    fused_less(s, Lanes::all(p.cosine), c * Lanes::all(p.sine)).store(sine);
    fused(s, Lanes::all(p.sine), c * Lanes::all(p.cosine)).store(cosine);
    offset = p.offset;
  }
  [[nodiscard]] Parameters of_block(std::size_t b) const { return {sine[b], cosine[b], offset}; }
};

inline void add_turned(double turn_sine, double turn_cosine, Lanes s, Lanes c, Lanes& total_s,
                       Lanes& total_c) {
  const Lanes ts = Lanes::all(turn_sine);
  const Lanes tc = Lanes::all(turn_cosine);
  total_s = total_s + fused(s, tc, c * ts);
  total_c = total_c + fused_less(s, ts, c * tc);
}

// NOLINTNEXTLINE(readability-function-size): the kernel table calls it with plain pointers
std::size_t fit_on_grid(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis,
                        const SampleGrid& grid, const double* const* values, std::size_t channels,
                        const Parameters* start, DesignSums& sums, ResidualSums* residual_sums) {
  const Anchors anchors = anchors_of(stamps, n, axis);
  const Lanes zero = Lanes::all(0.0);
  GridDesignLanes design{zero, zero, zero, zero};
  GridResidualLanes own[grid_call_channels];
  Lanes es[grid_call_channels], ec[grid_call_channels];
  TurnedStart turned[grid_call_channels];
  bool about_start = false;
  for (std::size_t j = 0; j < channels; ++j) {
    own[j].e = own[j].ee = es[j] = ec[j] = zero;
    turned[j].set(anchors, start[j]);
    about_start |= start[j].sine != 0.0 || start[j].cosine != 0.0;
  }
  std::size_t taken = 0;
  GridBasis basis;
  bool third_order = true; // until a block needs the fifth
  for (std::size_t b = 0; taken < n; ++b) {
    const GridPlace place(b, n);
    GridDesignLanes block;
    Parameters from[grid_call_channels];
    for (std::size_t j = 0; j < channels; ++j) {
      from[j] = turned[j].of_block(b);
    }
    bool summed = false;
    if constexpr (Lanes::channels_at_once == 4) {
      if (third_order && channels == 4 && !about_start) {
        third_order = summed =
            grid_block_of_four<Order::third>(stamps, place, grid, values, from, block, own);
      }
    }
    if (!summed) {
      if (third_order) {
        third_order =
            grid_design<Order::third>(stamps, place, grid, values, channels, basis, block);
      }
      if (!third_order &&
          !grid_design<Order::fifth>(stamps, place, grid, values, channels, basis, block)) {
        break;
      }
      if (about_start) {
        all_grid_residuals<true>(values, channels, place, basis, from, own);
      } else {
        all_grid_residuals<false>(values, channels, place, basis, from, own);
      }
    }
    add_turned(anchors.sine[b], anchors.cosine[b], block.s, block.c, design.s, design.c);
    add_turned(anchors.sine_twice[b], anchors.cosine_twice[b], block.sine_twice, block.cosine_twice,
               design.sine_twice, design.cosine_twice);
    for (std::size_t j = 0; j < channels; ++j) {
      add_turned(anchors.sine[b], anchors.cosine[b], own[j].es, own[j].ec, es[j], ec[j]);
    }
    taken += place.n;
  }
  const double count = static_cast<double>(taken);
  sums = {design.s.total(), design.c.total(), 0.5 * (count - design.cosine_twice.total()),
          0.5 * design.sine_twice.total()};
  for (std::size_t j = 0; j < channels; ++j) {
    residual_sums[j] = {own[j].e.total(), es[j].total(), ec[j].total(), own[j].ee.total()};
  }
  return taken;
}

} // namespace

// NOLINTEND(misc-definitions-in-headers)
