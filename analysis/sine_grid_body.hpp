// The fast form of the fit for nearly equidistant samples (sine_grid.hpp), written over the eight lanes of sine_kernel_body.hpp and
// included after it.
//
// Every block is summed in coordinates of its own, phases about its anchor, where sine and cosine are the grid's plus a small turn;
// the lanes of its sums are then turned to the common origin by the anchor's phase, which is reduced exactly. Of the design, the
// lanes keep sums of cos 2x = 1 - 2 s^2 and of sin 2x = 2 s c, which turn by the doubled phase.

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

// Where a block lies in the samples of a call and on the grid: a shorter one lies about the middle of the grid.
struct GridPlace {
  std::size_t first, n, on_grid;
  GridPlace(std::size_t block, std::size_t samples)
      : first(block * grid_samples), n(samples - first < grid_samples ? samples - first : grid_samples), on_grid((grid_samples - n) / 2) {}
  [[nodiscard]] std::size_t anchor() const { return first + grid_samples / 2 - on_grid; }
};

// Into the second-level cache: the processor follows one stream by itself, not one more for every channel; and more reads can be
// under way there than towards the first level.
template <class Number>
inline void prefetch_ahead(const Number* at) {
  constexpr std::size_t samples_ahead = 1024;
  __builtin_prefetch(at + samples_ahead, 0, 2);
}

// sin x and 1 - cos x of a small angle x = sqrt(2) scaled: what is x^2 / 2 need not be multiplied out.
template <Order order>
inline SineCosine small_turn(Lanes scaled) {
  constexpr double root = 1.4142135623730951;
  const Lanes z = scaled * scaled; // x^2 / 2
  if constexpr (order == Order::third) {
    return {scaled * fused_less(z, Lanes::all(root / 3.0), Lanes::all(root)), z};
  } else {
    const Lanes sine = fused_less(z, fused_less(z, Lanes::all(root / 30.0), Lanes::all(root / 3.0)), Lanes::all(root));
    return {scaled * sine, fused_less(z * z, Lanes::all(1.0 / 6.0), z)};
  }
}

// Sine and cosine of a sample from those of the grid.
template <Order order>
inline SineCosine turned_from_grid(Lanes scaled, Lanes s0, Lanes c0) {
  const SineCosine turn = small_turn<order>(scaled);
  return {s0 + fused_less(s0, turn.cosine, c0 * turn.sine), c0 - fused(c0, turn.cosine, s0 * turn.sine)};
}

// Sine and cosine of a block and their sums; false when not all samples are near enough for the order.
template <Order order>
inline bool grid_design(const std::int64_t* stamps, const GridPlace& place, const SampleGrid& grid, const double* const* values,
                        std::size_t channels, GridBasis& basis, GridDesignLanes& sums) {
  const double* channel_0 = values[0] + place.first;
  const double* channel_2 = values[channels > 2 ? 2 : 0] + place.first;
  const std::int64_t* from = stamps + place.first;
  const std::int64_t anchor_ns = stamps[place.anchor()];
  const std::int64_t* offsets_ns = grid.offsets_ns + place.on_grid;
  const double* grid_sine = grid.sine + place.on_grid;
  const double* grid_cosine = grid.cosine + place.on_grid;
  const Lanes scale = Lanes::all(grid.scaled_radians_per_ns);
  Lanes s = Lanes::all(0.0), c = s, ss = s, sc = s, largest = s;
  for (std::size_t i = 0; i < place.n; i += lanes) {
    prefetch_ahead(from + i);
    prefetch_ahead(channel_0 + i);
    prefetch_ahead(channel_2 + i);
    const Lanes d = time_difference(from + i, offsets_ns + i, anchor_ns);
    largest = larger_magnitude(largest, d);
    const SineCosine one = turned_from_grid<order>(d * scale, Lanes::load(grid_sine + i), Lanes::load(grid_cosine + i));
    one.sine.store(basis.sine + i);
    one.cosine.store(basis.cosine + i);
    s = s + one.sine;
    c = c + one.cosine;
    ss = fused(one.sine, one.sine, ss);
    sc = fused(one.sine, one.cosine, sc);
  }
  const Lanes rows = Lanes::all(static_cast<double>(place.n / lanes));
  sums = {s, c, fused_less(Lanes::all(2.0), ss, rows), sc + sc};
  return largest.all_at_most(order == Order::third ? grid.largest_of_third_order_ns : grid.largest_ns);
}

// `count` channels at once: e and ee of all blocks so far, es and ec of this one. Without a start value for sine and cosine their
// product with the basis is left out.
template <std::size_t count, bool about_start>
inline void grid_residuals(const double* const* values, const GridPlace& place, const GridBasis& basis, const Parameters* start,
                           GridResidualLanes* sums) {
  const double* from[count];
  Lanes e[count], es[count], ec[count], ee[count];
  for (std::size_t j = 0; j < count; ++j) {
    from[j] = values[j] + place.first;
    e[j] = sums[j].e;
    ee[j] = sums[j].ee;
    es[j] = ec[j] = Lanes::all(0.0);
  }
  for (std::size_t i = 0; i < place.n; i += lanes) {
    const Lanes s = Lanes::load(basis.sine + i);
    const Lanes c = Lanes::load(basis.cosine + i);
    for (std::size_t j = 0; j < count; ++j) {
      if (j % 2 == 1) prefetch_ahead(from[j] + i);
      Lanes r = Lanes::load(from[j] + i) - Lanes::all(start[j].offset);
      if constexpr (about_start) r = fused_less(Lanes::all(start[j].sine), s, fused_less(Lanes::all(start[j].cosine), c, r));
      e[j] = e[j] + r;
      es[j] = fused(r, s, es[j]);
      ec[j] = fused(r, c, ec[j]);
      ee[j] = fused(r, r, ee[j]);
    }
  }
  for (std::size_t j = 0; j < count; ++j)
    sums[j] = {e[j], es[j], ec[j], ee[j]};
}

template <bool about_start>
inline void all_grid_residuals(const double* const* values, std::size_t channels, const GridPlace& place, const GridBasis& basis,
                               const Parameters* start, GridResidualLanes* sums) {
  std::size_t j = 0;
  if constexpr (Lanes::channels_at_once == 4) {
    for (; j + 4 <= channels; j += 4)
      grid_residuals<4, about_start>(values + j, place, basis, start + j, sums + j);
    for (; j + 2 <= channels; j += 2)
      grid_residuals<2, about_start>(values + j, place, basis, start + j, sums + j);
  }
  for (; j < channels; ++j)
    grid_residuals<1, about_start>(values + j, place, basis, start + j, sums + j);
}

inline Anchors anchors_of(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis) {
  std::int64_t anchors_ns[lanes];
  for (std::size_t b = 0; b < lanes; ++b)
    anchors_ns[b] = stamps[b * grid_samples < n ? GridPlace(b, n).anchor() : 0];
  const Lanes dt = time_difference(anchors_ns, axis.origin_ns);
  const SineCosine turn = sine_cosine_of_time(dt, Lanes::all(axis.turns_per_ns_high), Lanes::all(axis.turns_per_ns_low));
  Anchors anchors;
  turn.sine.store(anchors.sine);
  turn.cosine.store(anchors.cosine);
  const Lanes twice = turn.sine + turn.sine;
  (twice * turn.cosine).store(anchors.sine_twice);
  fused_less(twice, turn.sine, Lanes::all(1.0)).store(anchors.cosine_twice);
  return anchors;
}

// Start values of a channel about the anchors of all blocks. By lanes too: GCC 12 contracts pairs of scalar sums and differences of
// products even when told not to.
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

inline void add_turned(double turn_sine, double turn_cosine, Lanes s, Lanes c, Lanes& total_s, Lanes& total_c) {
  const Lanes ts = Lanes::all(turn_sine);
  const Lanes tc = Lanes::all(turn_cosine);
  total_s = total_s + fused(s, tc, c * ts);
  total_c = total_c + fused_less(s, ts, c * tc);
}

std::size_t fit_on_grid(const std::int64_t* stamps, std::size_t n, const TimeAxis& axis, const SampleGrid& grid,
                        const double* const* values, std::size_t channels, const Parameters* start, DesignSums& sums,
                        ResidualSums* residual_sums) {
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
    if (third_order) third_order = grid_design<Order::third>(stamps, place, grid, values, channels, basis, block);
    if (!third_order && !grid_design<Order::fifth>(stamps, place, grid, values, channels, basis, block)) break;
    add_turned(anchors.sine[b], anchors.cosine[b], block.s, block.c, design.s, design.c);
    add_turned(anchors.sine_twice[b], anchors.cosine_twice[b], block.sine_twice, block.cosine_twice, design.sine_twice,
               design.cosine_twice);
    Parameters from[grid_call_channels];
    for (std::size_t j = 0; j < channels; ++j)
      from[j] = turned[j].of_block(b);
    if (about_start)
      all_grid_residuals<true>(values, channels, place, basis, from, own);
    else
      all_grid_residuals<false>(values, channels, place, basis, from, own);
    for (std::size_t j = 0; j < channels; ++j)
      add_turned(anchors.sine[b], anchors.cosine[b], own[j].es, own[j].ec, es[j], ec[j]);
    taken += place.n;
  }
  const double count = static_cast<double>(taken);
  sums = {design.s.total(), design.c.total(), 0.5 * (count - design.cosine_twice.total()), 0.5 * design.sine_twice.total()};
  for (std::size_t j = 0; j < channels; ++j)
    residual_sums[j] = {own[j].e.total(), es[j].total(), ec[j].total(), own[j].ee.total()};
  return taken;
}

} // namespace
