// Sums of linear models of any number of columns (extended_sine_fit.hpp) over one block, written
// over the eight lanes of sine_kernel_body.hpp and included after it.

// NOLINTBEGIN(misc-definitions-in-headers): every translation unit that includes this has its own,
// without linkage

namespace {

void model_residuals(const double* values, std::size_t n, const double* columns, std::size_t count,
                     const double* coefficients, double* residuals, double& squares) {
  Lanes ee = Lanes::all(0.0);
  const auto row = [&](std::size_t i, auto rows) {
    Lanes e = load_row(values + i, rows);
    for (std::size_t k = 0; k < count; ++k) {
      e = fused_less(Lanes::all(coefficients[k]), Lanes::load(columns + k * block_samples + i), e);
    }
    e = masked(e, rows);
    e.store(residuals + i);
    ee = fused(e, e, ee);
  };
  const std::size_t full = full_groups(n);
  for (std::size_t i = 0; i < full; i += lanes) {
    row(i, AllOfRow{});
  }
  row(full, PartOfRow{n - full});
  squares = ee.total();
}

// `at_once` columns in one go: their sums do not wait for each other.
template <std::size_t at_once>
inline void products_with(const double* one, std::size_t n, const double* columns,
                          double* products) {
  Lanes sums[at_once];
  for (Lanes& sum : sums) {
    sum = Lanes::all(0.0);
  }
  for (std::size_t i = 0; i < n; i += lanes) {
    const Lanes x = Lanes::load(one + i);
    for (std::size_t k = 0; k < at_once; ++k) {
      sums[k] = fused(x, Lanes::load(columns + k * block_samples + i), sums[k]);
    }
  }
  for (std::size_t k = 0; k < at_once; ++k) {
    products[k] = sums[k].total();
  }
}

void model_products(const double* one, std::size_t n, const double* columns, std::size_t count,
                    double* products) {
  std::size_t k = 0;
  for (; k + 4 <= count; k += 4) {
    products_with<4>(one, n, columns + k * block_samples, products + k);
  }
  for (; k < count; ++k) {
    products_with<1>(one, n, columns + k * block_samples, products + k);
  }
}

} // namespace

// NOLINTEND(misc-definitions-in-headers)
