// One axis of a plot: its range, where its ticks stand and how they are labelled.
//
// Linear axes have ticks at multiples of 1, 2 or 5 times a power of ten. Logarithmic axes have
// labels at the powers of ten, and at 2 and 5 between them where few powers are in range; other
// mantissas are ticks without a label. Values that cannot be drawn (not finite, or not positive on
// a logarithmic axis) do not widen a range.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace dyncal::inline views::figures {

enum class Scale { linear, logarithmic };

struct Tick {
  double value;
  std::string label; // empty: a minor tick
};

struct Axis {
  Scale scale = Scale::linear;
  double low = 0;
  double high = 1;
  std::vector<Tick> ticks;
  std::string factor; // what all labels are to be multiplied with, e.g. "×10⁻⁴"; empty for 1

  // 0 at `low`, 1 at `high`.
  [[nodiscard]] double position(double value) const;
  [[nodiscard]] bool can_show(double value) const;
};

// The smallest and largest of the values seen so far.
class Range {
public:
  explicit Range(Scale scale = Scale::linear) : scale_(scale) {}
  void include(double value);
  void include(std::span<const double> values);

  [[nodiscard]] bool empty() const { return low_ > high_; }
  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return high_; }
  // Room of `fraction` of the range at both ends; a range of one value gets some width, an empty
  // one becomes 0..1 (1..10).
  [[nodiscard]] Range padded(double fraction) const;
  [[nodiscard]] Scale scale() const { return scale_; }

private:
  Scale scale_;
  double low_ = 1;
  double high_ = 0;
};

// The axis over exactly this range, with about `ticks` labels; a range of one value or none is
// padded first.
[[nodiscard]] Axis make_axis(const Range& range, int ticks);

// The same with ticks at these values, rising, as far as they are in the range; those have labels
// that are one character apart at least. `character` is its width as a part of the axis.
[[nodiscard]] Axis make_axis(const Range& range, std::span<const double> ticks, double character);

// "10⁻⁴"
[[nodiscard]] std::string power_of_ten(int exponent);

} // namespace dyncal::inline views::figures
