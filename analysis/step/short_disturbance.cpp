#include "analysis/step/short_disturbance.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/base/statistics.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr double window_s = 5e-3;
constexpr std::size_t min_window = 8; // samples
constexpr std::size_t min_windows = 30;
constexpr double stands_out = 8.0; // rms of a window, in medians of all
constexpr double max_part = 0.1;   // of the record
constexpr int max_rounds = 8;

struct Stretch { // samples, [begin, end)
  std::size_t begin = 0;
  std::size_t end = 0;
};

class Search {
public:
  Search(const Frequency& frequency, std::span<const std::int64_t> stamps_ns,
         std::span<const double> values, std::size_t window)
      : frequency_(frequency), stamps_ns_(stamps_ns), values_(values), window_(window),
        windows_((stamps_ns.size() + window - 1) / window), out_(windows_, false),
        sine_(values.size()), cosine_(values.size()) {
    fill_sine_cosine(frequency, stamps_ns.front(), stamps_ns, sine_.data(), cosine_.data());
  }

  // The windows that stand out, once these stay the same.
  [[nodiscard]] std::optional<Stretch> run() {
    for (int round = 0; round < max_rounds; ++round) {
      const auto next = windows_beside(round);
      if (!next) {
        return std::nullopt;
      }
      if (*next == out_) {
        return stretch();
      }
      out_ = *next;
    }
    return std::nullopt;
  }

private:
  [[nodiscard]] std::size_t end_of(std::size_t window) const {
    return std::min(values_.size(), (window + 1) * window_);
  }

  [[nodiscard]] Expected<SineFit> fit_others() const {
    std::vector<std::int64_t> stamps;
    std::vector<double> values;
    for (std::size_t w = 0; w < windows_; ++w) {
      if (!out_[w]) {
        stamps.insert(stamps.end(), stamps_ns_.begin() + static_cast<std::ptrdiff_t>(w * window_),
                      stamps_ns_.begin() + static_cast<std::ptrdiff_t>(end_of(w)));
        values.insert(values.end(), values_.begin() + static_cast<std::ptrdiff_t>(w * window_),
                      values_.begin() + static_cast<std::ptrdiff_t>(end_of(w)));
      }
    }
    const std::span<const double> channel[] = {values};
    return fit_sine(frequency_, stamps_ns_.front(), stamps, channel)
        .map([](const std::vector<SineFit>& fits) { return fits.front(); });
  }

  // Those that stand out beside the others' sine, and their neighbours. The first rounds look for
  // the worst alone, for a large knock bends the sine everywhere.
  [[nodiscard]] std::optional<std::vector<bool>> windows_beside(int round) const {
    const auto fit = fit_others();
    if (!fit) {
      return std::nullopt;
    }
    std::vector<double> rms;
    for (std::size_t w = 0; w < windows_; ++w) {
      double squares = 0.0;
      for (std::size_t i = w * window_; i < end_of(w); ++i) {
        const double e = values_[i] - fit->sine * sine_[i] - fit->cosine * cosine_[i] - fit->offset;
        squares += e * e;
      }
      rms.push_back(std::sqrt(squares / static_cast<double>(end_of(w) - w * window_)));
    }
    const double usual = median(rms);
    const double largest = *std::max_element(rms.begin(), rms.end());
    double limit = stands_out * usual;
    if (round == 0) {
      limit = std::max(limit, 0.25 * largest);
      limit = std::min(limit, 0.5 * largest); // a knock bends the sine, and hides behind that
    }
    std::vector<bool> out(windows_, false);
    for (std::size_t w = 0; w < windows_; ++w) {
      if (rms[w] > limit) {
        for (std::size_t k = w > 0 ? w - 1 : 0; k < std::min(windows_, w + 2); ++k) {
          out[k] = true;
        }
      }
    }
    return out;
  }

  // The one stretch that they are.
  [[nodiscard]] std::optional<Stretch> stretch() const {
    const auto first = std::find(out_.begin(), out_.end(), true);
    const auto last = std::find(first, out_.end(), false);
    if (first == out_.end() || std::find(last, out_.end(), true) != out_.end()) {
      return std::nullopt;
    }
    const Stretch found{static_cast<std::size_t>(first - out_.begin()) * window_,
                        end_of(static_cast<std::size_t>(last - out_.begin()) - 1)};
    const double part =
        static_cast<double>(found.end - found.begin) / static_cast<double>(values_.size());
    return part <= max_part && !repeats(found) ? std::optional(found) : std::nullopt;
  }

  [[nodiscard]] bool repeats(const Stretch& part) const {
    std::size_t equal = 0;
    for (std::size_t i = part.begin + 1; i < part.end; ++i) {
      equal += values_[i] == values_[i - 1] ? 1 : 0;
    }
    return 2 * equal > part.end - part.begin;
  }

  const Frequency& frequency_;
  std::span<const std::int64_t> stamps_ns_;
  std::span<const double> values_;
  std::size_t window_, windows_;
  std::vector<bool> out_;
  std::vector<double> sine_, cosine_;
};

} // namespace

std::optional<ShortDisturbance> find_short_disturbance(const Frequency& frequency,
                                                       std::span<const std::int64_t> stamps_ns,
                                                       std::span<const double> values) {
  const std::size_t n = stamps_ns.size();
  if (n < min_windows * min_window) {
    return std::nullopt;
  }
  const double duration_s = static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
  const auto window = std::max(
      min_window,
      static_cast<std::size_t>(std::llround(window_s * static_cast<double>(n - 1) / duration_s)));
  if (n < min_windows * window) {
    return std::nullopt;
  }
  const auto found = Search(frequency, stamps_ns, values, window).run();
  return found ? std::optional(ShortDisturbance{stamps_ns[found->begin], stamps_ns[found->end - 1]})
               : std::nullopt;
}

} // namespace dyncal::analysis
