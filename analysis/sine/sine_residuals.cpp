#include "analysis/sine/sine_residuals.hpp"

#include <algorithm>
#include <memory>

#include "analysis/sine/kernel/sine_kernel.hpp"
#include "analysis/sine/sine_pass.hpp"
#include "analysis/sine/sine_solve.hpp"

namespace dyncal::analysis {
namespace {

using namespace kernel;

static_assert(value_block_samples == block_samples);

double total(const double* sum) {
  return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
}

// The sums of one set of lines, eight lanes each.
class LineSetSums {
public:
  LineSetSums(const LineSet& set, const Record& record, std::size_t channels)
      : set_(set), axis_(record.axis(set.frequency)),
        design_(static_cast<std::size_t>(set.orders) * line_design_sums * lanes),
        products_(channels, std::vector<double>(static_cast<std::size_t>(set.orders) * 2 * lanes)) {
    for (auto& of_channel : products_) {
      pointers_.push_back(of_channel.data());
    }
  }

  [[nodiscard]] const TimeAxis& axis() const { return axis_; }

  void add(const BlockBasis& basis, std::size_t n, const std::vector<const double*>& residuals) {
    best_kernel().line_sums(basis, n, static_cast<std::size_t>(set_.first_order),
                            static_cast<std::size_t>(set_.orders), residuals.data(),
                            residuals.size(), design_.data(), pointers_.data());
  }

  // Fits of all orders to the residuals of a channel.
  [[nodiscard]] std::vector<std::optional<ResidualLine>> lines(std::size_t channel,
                                                               const TimeSums& sums) const {
    std::vector<std::optional<ResidualLine>> result;
    for (std::size_t k = 0; k < static_cast<std::size_t>(set_.orders); ++k) {
      const double* design = design_.data() + k * line_design_sums * lanes;
      const double* products = products_[channel].data() + 2 * k * lanes;
      result.push_back(line(sums,
                            {total(design), total(design + lanes), total(design + 2 * lanes),
                             total(design + 3 * lanes)},
                            {sums.eu[0], total(products), total(products + lanes), sums.ee}));
    }
    return result;
  }

private:
  static std::optional<ResidualLine> line(const TimeSums& sums, const DesignSums& design,
                                          const ResidualSums& residuals) {
    const NormalMatrix matrix(sums.samples, design);
    if (!matrix.well_conditioned()) {
      return std::nullopt;
    }
    const Solution solution = solve(matrix, residuals, {0.0, 0.0, 0.0});
    ResidualLine line;
    line.fit.sine = solution.p.sine;
    line.fit.cosine = solution.p.cosine;
    line.fit.offset = solution.p.offset;
    line.fit.rss = solution.rss;
    line.fit.samples = static_cast<std::uint64_t>(sums.samples);
    line.fit.degrees_of_freedom = sums.samples - 3.0;
    line.fit.covariance = unit_covariance(matrix);
    for (double& element : line.fit.covariance) {
      element *= solution.rss / line.fit.degrees_of_freedom;
    }
    line.gain = residuals.ee - residuals.e * (residuals.e / sums.samples) - solution.rss;
    return line;
  }

  LineSet set_;
  TimeAxis axis_;
  std::vector<double> design_;
  std::vector<std::vector<double>> products_;
  std::vector<double*> pointers_;
};

// Takes the polynomial away from a block of residuals.
void remove_polynomial(std::span<const double> powers, const BlockBasis& basis, std::size_t n,
                       double* residuals) {
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0.0;
    for (std::size_t k = powers.size(); k-- > 0;) {
      sum = (sum + powers[k]) * basis.u[i];
    }
    residuals[i] -= sum;
  }
}

class Reduction {
public:
  Reduction(const ResidualSearch& search, const Record& record, std::span<const SineFit> fits)
      : search_(search), record_(record), channels_(fits.size()),
        residuals_(std::make_unique_for_overwrite<double[]>(fits.size() * block_samples)) {
    for (std::size_t j = 0; j < fits.size(); ++j) {
      start_.push_back({fits[j].sine, fits[j].cosine, fits[j].offset});
      pointers_.push_back(residuals_.get() + j * block_samples);
      channels_[j].blocks.reserve(record.size() / block_samples + 1);
    }
    sums_.resize(fits.size());
    sets_.emplace_back(search.first, record, fits.size());
    for (const LineSet& set : search.others) {
      sets_.emplace_back(set, record, fits.size());
    }
  }

  [[nodiscard]] Expected<std::vector<ChannelResiduals>> run() {
    for (std::size_t i = 0; i < record_.size(); i += block_samples) {
      if (!add(i, std::min(block_samples, record_.size() - i))) {
        return fail(record_.not_increasing());
      }
    }
    return results();
  }

private:
  bool add(std::size_t first, std::size_t n) {
    const SineKernel& kernel = best_kernel();
    const std::int64_t* stamps = record_.stamps().data() + first;
    if (!kernel.design_with_time(stamps, n, sets_.front().axis(), basis_, time_.data())) {
      return false;
    }
    for (std::size_t j = 0; j < channels_.size(); ++j) {
      add_channel(j, record_.channels()[j].data() + first, n);
    }
    sets_.front().add(basis_, n, pointers_);
    for (std::size_t k = 1; k < sets_.size(); ++k) {
      DesignSums unused;
      kernel.design(stamps, n, sets_[k].axis(), basis_, unused);
      sets_[k].add(basis_, n, pointers_);
    }
    return true;
  }

  void add_channel(std::size_t j, const double* values, std::size_t n) {
    const SineKernel& kernel = best_kernel();
    double* residuals = residuals_.get() + j * block_samples;
    std::array<double, residual_time_sums* lanes> before = sums_[j];
    kernel.residuals_with_time(values, n, basis_, start_[j], residuals, sums_[j].data());
    if (!search_.drifts.empty() && !search_.drifts[j].empty()) {
      remove_polynomial(search_.drifts[j], basis_, n, residuals);
      sums_[j] = before;
      kernel.residuals_with_time(residuals, n, basis_, {0.0, 0.0, 0.0}, residuals, sums_[j].data());
    }
    ValueBlock& block = channels_[j].blocks.emplace_back();
    block.repeats = kernel.value_range(values, n, block.low, block.high);
  }

  [[nodiscard]] std::vector<ChannelResiduals> results() {
    for (std::size_t j = 0; j < channels_.size(); ++j) {
      TimeSums& time = channels_[j].time;
      time.samples = time.u[0] = static_cast<double>(record_.size());
      for (std::size_t m = 0; m < design_time_sums; ++m) {
        time.u[m + 1] = total(time_.data() + m * lanes);
      }
      for (std::size_t m = 0; m < time.eu.size(); ++m) {
        time.eu[m] = total(sums_[j].data() + m * lanes);
      }
      time.ee = total(sums_[j].data() + 4 * lanes);
      for (const LineSetSums& set : sets_) {
        channels_[j].lines.push_back(set.lines(j, time));
      }
    }
    return std::move(channels_);
  }

  const ResidualSearch& search_;
  const Record& record_;
  std::vector<ChannelResiduals> channels_;
  std::unique_ptr<double[]> residuals_; // of one block, channel by channel
  std::vector<Parameters> start_;
  std::vector<const double*> pointers_;
  std::array<double, design_time_sums * lanes> time_{};
  std::vector<std::array<double, residual_time_sums * lanes>> sums_;
  std::vector<LineSetSums> sets_;
  BlockBasis basis_;
};

} // namespace

Expected<std::vector<ChannelResiduals>>
reduce_residuals(const ResidualSearch& search, std::span<const std::int64_t> stamps_ns,
                 std::span<const std::span<const double>> channels, std::span<const SineFit> fits) {
  DYNCAL_TRY(const auto record, Record::make(stamps_ns, channels, 3));
  return Reduction(search, record, fits).run();
}

PlainChannel plain_channel(const SineFit& fit, const LineSet& harmonics,
                           const ChannelResiduals& residuals) {
  PlainChannel plain{fit, {}, residuals.blocks};
  const auto& lines = residuals.lines.front();
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (lines[k]) {
      plain.harmonics.push_back({harmonics.first_order + static_cast<int>(k), *lines[k]});
    }
  }
  return plain;
}

std::int64_t middle_of_record_ns(std::span<const std::int64_t> stamps_ns) {
  return stamps_ns.front() + (stamps_ns.back() - stamps_ns.front()) / 2;
}

} // namespace dyncal::analysis
