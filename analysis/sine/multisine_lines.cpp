#include "analysis/sine/multisine_lines.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>

#include "analysis/base/frequency.hpp"

namespace dyncal::analysis {
namespace {

constexpr double min_period_s = 1.0;
constexpr double max_period_s = 100.0;
constexpr double mains_tolerance_rel = 0.004; // what a grid in trouble may be off
constexpr double lines_beside_mains = 2.0;    // of the grid: what a record of one period resolves
constexpr std::size_t max_sentences = 6;      // then the others are only counted

tl::unexpected<Error> refuse(std::string sentence) {
  return fail(ErrorCode::invalid_argument, std::move(sentence));
}

// Without zeros behind the point.
std::string text_of_millihertz(std::int64_t millihertz) {
  std::string text = std::to_string(millihertz / 1000);
  std::string decimals = std::to_string(1000 + millihertz % 1000).substr(1);
  while (!decimals.empty() && decimals.back() == '0') {
    decimals.pop_back();
  }
  return decimals.empty() ? text : text + "." + decimals;
}

struct Grid {
  std::int64_t millihertz; // between two lines
  [[nodiscard]] double hz() const { return 1e-3 * static_cast<double>(millihertz); }
  [[nodiscard]] std::string text_of(std::int64_t line) const {
    return text_of_millihertz(line * millihertz);
  }
};

Expected<Grid> grid_of(double period_s) {
  const double millihertz = 1000.0 / period_s;
  if (!(period_s >= min_period_s && period_s <= max_period_s) ||
      std::abs(millihertz - std::round(millihertz)) > 1e-9 * millihertz) {
    return refuse("a multi-sine has a period of 1 s to 100 s with a whole number of millihertz "
                  "between its lines, such as 5 s, 8 s, 10 s or 20 s");
  }
  return Grid{std::llround(millihertz)};
}

// The line of the mains that is too near, if any.
std::optional<double> near_mains(double hz, const Grid& grid, std::span<const double> mains_hz) {
  for (const double mains : mains_hz) {
    const double line = mains * std::max(1.0, std::round(hz / mains));
    if (std::abs(hz - line) < mains_tolerance_rel * line + lines_beside_mains * grid.hz()) {
      return line;
    }
  }
  return std::nullopt;
}

std::string product_text(const Grid& grid, std::int64_t a, const char* sign, std::int64_t b,
                         std::int64_t of) {
  return grid.text_of(a) + " Hz " + sign + " " + grid.text_of(b) + " Hz = " + grid.text_of(of) +
         " Hz";
}

// What two or three of these lines do to each other; empty where nothing.
std::vector<std::string> collisions(const Grid& grid, const std::vector<std::int64_t>& lines) {
  std::vector<std::string> found;
  const auto excited = [&](std::int64_t line) {
    return std::ranges::find(lines, line) != lines.end();
  };
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::int64_t order = 2; order <= 3; ++order) {
      if (excited(order * lines[i])) {
        found.push_back(std::to_string(order) + " times " + grid.text_of(lines[i]) +
                        " Hz = " + grid.text_of(order * lines[i]) + " Hz");
      }
    }
    for (std::size_t j = 0; j < i; ++j) {
      const auto [low, high] = std::minmax(lines[i], lines[j]);
      if (high - low < min_line_distance) {
        found.push_back(grid.text_of(low) + " Hz and " + grid.text_of(high) +
                        " Hz are nearer than " + grid.text_of(min_line_distance) + " Hz");
      }
      if (excited(high + low)) {
        found.push_back(product_text(grid, low, "+", high, high + low));
      }
    }
  }
  return found;
}

std::string listed(const std::vector<std::string>& sentences) {
  std::string text;
  for (std::size_t i = 0; i < std::min(sentences.size(), max_sentences); ++i) {
    text += (i == 0 ? "" : "; ") + sentences[i];
  }
  return sentences.size() > max_sentences
             ? text + "; and " + std::to_string(sentences.size() - max_sentences) + " more"
             : text;
}

Expected<double> parse_hz(const std::string& text) {
  DYNCAL_TRY(const auto frequency, Frequency::parse(text));
  return frequency.hz();
}

// The nearest first, within what a wish allows; of two as near the higher one.
std::vector<std::int64_t> candidates(double wish_hz, const Grid& grid) {
  const std::int64_t wish_millihertz = std::llround(1000.0 * wish_hz);
  const auto first =
      static_cast<std::int64_t>(std::ceil((1.0 - max_line_shift_rel) * wish_hz / grid.hz()));
  const auto last =
      static_cast<std::int64_t>(std::floor((1.0 + max_line_shift_rel) * wish_hz / grid.hz()));
  std::vector<std::int64_t> lines;
  for (std::int64_t line = last % 2 == 0 ? last - 1 : last; line >= first; line -= 2) {
    lines.push_back(line);
  }
  std::ranges::stable_sort(lines, {}, [&](std::int64_t line) {
    return std::abs(line * grid.millihertz - wish_millihertz);
  });
  return lines;
}

} // namespace

Expected<std::vector<std::string>> propose_multisine_lines(std::span<const std::string> wishes_hz,
                                                           double period_s,
                                                           std::span<const double> mains_hz) {
  DYNCAL_TRY(const auto grid, grid_of(period_s));
  std::vector<std::int64_t> lines;
  std::vector<std::string> texts;
  for (const std::string& wish : wishes_hz) {
    DYNCAL_TRY(const auto wish_hz, parse_hz(wish));
    const std::vector<std::int64_t> possible = candidates(wish_hz, grid);
    const auto free = std::ranges::find_if(possible, [&](std::int64_t line) {
      std::vector<std::int64_t> with = lines;
      with.push_back(line);
      return !near_mains(static_cast<double>(line) * grid.hz(), grid, mains_hz) &&
             collisions(grid, with).empty();
    });
    if (free == possible.end()) {
      return refuse("no line of a period of " + text_of_millihertz(std::llround(1e3 * period_s)) +
                    " s is free within 3 % of " + wish +
                    " Hz; take a longer period, or leave it out");
    }
    lines.push_back(*free);
    texts.push_back(grid.text_of(*free));
  }
  return texts;
}

Expected<void> check_multisine_lines(std::span<const std::string> lines_hz, double period_s,
                                     std::span<const double> mains_hz) {
  DYNCAL_TRY(const auto grid, grid_of(period_s));
  if (lines_hz.size() < 2) {
    return refuse("a multi-sine has two lines at least");
  }
  std::vector<std::int64_t> lines;
  std::vector<std::string> beside;
  for (const std::string& text : lines_hz) {
    DYNCAL_TRY(const auto hz, parse_hz(text));
    const double line = hz / grid.hz();
    if (std::abs(line - std::round(line)) > 1e-6) {
      return refuse(text + " Hz is no multiple of the " + grid.text_of(1) +
                    " Hz between the lines of the period");
    }
    lines.push_back(std::llround(line));
    if (const auto mains = near_mains(hz, grid, mains_hz)) {
      beside.push_back(text + " Hz is beside the mains at " +
                       text_of_millihertz(std::llround(1e3 * *mains)) + " Hz");
    }
  }
  std::vector<std::string> found = collisions(grid, lines);
  found.insert(found.end(), beside.begin(), beside.end());
  if (!found.empty()) {
    return refuse("lines collide: " + listed(found));
  }
  for (const std::int64_t line : lines) {
    if (line % 2 == 0) {
      return refuse(grid.text_of(line) + " Hz is an even multiple of " + grid.text_of(1) +
                    " Hz, where the distortion of the other lines is looked for; take " +
                    grid.text_of(line + 1) + " Hz");
    }
  }
  return {};
}

} // namespace dyncal::analysis
