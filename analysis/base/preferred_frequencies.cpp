#include "analysis/base/preferred_frequencies.hpp"

#include <array>

#include "analysis/base/frequency.hpp"
#include "analysis/base/text.hpp"

namespace dyncal::analysis {
namespace {

// Digits of the nominal values in a decade, and where the point stands behind the first.
constexpr std::array<std::string_view, 10> digits{"1",   "125", "16", "2",  "25",
                                                  "315", "4",   "5",  "63", "8"};
constexpr int lowest_decade = -2;
constexpr int highest_decade = 6;
constexpr double lowest_hz = 0.01;
constexpr double highest_hz = 1e6;

struct Series {
  std::string_view name;
  int stride; // in third octaves
};
constexpr std::array all_series{Series{"third-octave ", 1}, Series{"octave ", 3}};

std::string text_of(std::string_view significant, int decade) {
  std::string text(significant);
  if (decade < 0) {
    return "0." + std::string(static_cast<std::size_t>(-decade - 1), '0') + text;
  }
  const std::size_t before_point = static_cast<std::size_t>(decade) + 1;
  if (text.size() <= before_point) {
    return text.append(before_point - text.size(), '0');
  }
  return text.insert(before_point, ".");
}

struct Range {
  double from_hz;
  double to_hz;
};

std::optional<Range> parse_range(std::string_view text) {
  const std::size_t dots = text.find("..");
  if (dots == std::string_view::npos) {
    return std::nullopt;
  }
  const auto from = Frequency::parse(trimmed(text.substr(0, dots)));
  const auto to = Frequency::parse(trimmed(text.substr(dots + 2)));
  if (!from || !to || from->hz() < lowest_hz || to->hz() > highest_hz || from->hz() > to->hz()) {
    return std::nullopt;
  }
  return Range{from->hz(), to->hz()};
}

std::vector<std::string> frequencies_in(Range range, int stride) {
  constexpr int per_decade = static_cast<int>(digits.size());
  std::vector<std::string> found;
  for (int number = lowest_decade * per_decade; number <= highest_decade * per_decade; ++number) {
    const int decade = number >= 0 ? number / per_decade : (number + 1) / per_decade - 1;
    const auto within = static_cast<std::size_t>(number - decade * per_decade);
    std::string text = text_of(digits.at(within), decade);
    const double hz = Frequency::parse(text)->hz();
    if (number % stride == 0 && hz >= range.from_hz && hz <= range.to_hz) {
      found.push_back(std::move(text));
    }
  }
  return found;
}

} // namespace

std::optional<std::vector<std::string>> preferred_frequencies(std::string_view text) {
  const std::string_view wish = trimmed(text);
  for (const Series& series : all_series) {
    if (wish.starts_with(series.name)) {
      const auto range = parse_range(wish.substr(series.name.size()));
      return range ? std::optional(frequencies_in(*range, series.stride)) : std::nullopt;
    }
  }
  return std::nullopt;
}

} // namespace dyncal::analysis
