// How far passes over the samples are that solve for many columns, one channel after the other
// (extended_sine_fit.hpp): counted in products of two numbers, of which those of the matrix are by
// far the most where there are many columns. One thread.
#pragma once

#include <algorithm>
#include <cstddef>

#include "analysis/base/progress.hpp"
#include "analysis/sine/kernel/sine_kernel.hpp"

namespace dyncal::analysis {

// Of each channel a pass with the matrix, and then passes without it.
struct PassWork {
  std::size_t channels = 0;
  std::size_t samples = 0;
  std::size_t columns = 0;
  int further_passes = 0; // at the most
};

class PassProgress {
public:
  // `progress` outlives the object.
  PassProgress(const Progress& progress, const PassWork& work)
      : progress_(progress), columns_(static_cast<double>(work.columns)),
        of_channel_(static_cast<double>(work.samples) *
                    (of_sample(true) + work.further_passes * of_sample(false))),
        all_(of_channel_ * static_cast<double>(work.channels)) {}

  // Those before it are done; REQUIRES: at most as many as there are.
  void begin_channel(std::size_t channel) {
    before_ = static_cast<double>(channel) * of_channel_;
    now_ = 0.0;
    report();
  }
  // A pass has `samples` more behind it, `done` in all.
  void add_samples(std::size_t samples, std::size_t done, bool with_matrix) {
    now_ += static_cast<double>(samples) * of_sample(with_matrix);
    if (done % stretch == 0) {
      report();
    }
  }

private:
  static constexpr std::size_t stretch = 64 * kernel::block_samples;

  [[nodiscard]] double of_sample(bool with_matrix) const {
    constexpr double without_matrix = 4.0; // the basis, the model, the residual, its products
    return columns_ * (without_matrix + (with_matrix ? 0.5 * columns_ : 0.0));
  }
  void report() const {
    if (progress_) {
      progress_((before_ + std::min(now_, of_channel_)) / all_);
    }
  }

  const Progress& progress_;
  double columns_;
  double of_channel_;
  double all_;
  double before_ = 0.0; // of the channels before this one
  double now_ = 0.0;    // of this one
};

} // namespace dyncal::analysis
