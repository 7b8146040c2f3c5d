#include "analysis/base/frequency.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace dyncal::analysis {
namespace {

// Decimal digits that are kept; the double-double behind holds about 32.
constexpr int max_digits = 36;

struct DoubleDouble {
  double high;
  double low;
};

DoubleDouble normalised(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)}; // REQUIRES: |a| >= |b| or a == 0
}

DoubleDouble times_ten_plus(DoubleDouble x, int digit) {
  const double product = x.high * 10.0;
  const double rest = std::fma(x.high, 10.0, -product) + x.low * 10.0;
  const double sum = product + digit; // the larger term is not known beforehand: two-sum
  const double part = sum - product;
  const double error = (product - (sum - part)) + (digit - part);
  return normalised(sum, rest + error);
}

DoubleDouble times(DoubleDouble a, DoubleDouble b) {
  const double product = a.high * b.high;
  const double rest = std::fma(a.high, b.high, -product) + (a.high * b.low + a.low * b.high);
  return normalised(product, rest);
}

DoubleDouble divided(DoubleDouble a, DoubleDouble b) {
  const double first = a.high / b.high;
  const double left = std::fma(-first, b.high, a.high) + (a.low - first * b.low);
  const double second = left / b.high;
  const DoubleDouble q = normalised(first, second);
  // One more step makes up for what the two quotients left: a - q b, in about 106 bits.
  const DoubleDouble qb = times(q, b);
  const double third = ((a.high - qb.high) + (a.low - qb.low)) / b.high;
  return normalised(q.high, q.low + third);
}

DoubleDouble power_of_ten(int exponent) {
  DoubleDouble result{1.0, 0.0};
  for (int i = 0; i < exponent; ++i) {
    result = times_ten_plus(result, 0);
  }
  return result;
}

DoubleDouble scaled_by_ten(DoubleDouble x, int exponent) {
  return exponent >= 0 ? times(x, power_of_ten(exponent)) : divided(x, power_of_ten(-exponent));
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// The number is digits * 10^exponent.
struct Decimal {
  DoubleDouble digits{0.0, 0.0};
  int exponent = 0;
  bool negative = false;
};

class DecimalReader {
public:
  explicit DecimalReader(std::string_view text) : text_(text) {}

  // False unless the whole text is one number.
  bool read(Decimal& out) {
    out.negative = take('-');
    if (!out.negative) {
      take('+');
    }
    const std::size_t before = position_;
    read_digits(out, false);
    std::size_t count = position_ - before;
    if (take('.')) {
      const std::size_t fraction = position_;
      read_digits(out, true);
      count += position_ - fraction;
    }
    return count > 0 && read_exponent(out) && position_ == text_.size();
  }

private:
  bool take(char c) {
    if (position_ == text_.size() || text_[position_] != c) {
      return false;
    }
    ++position_;
    return true;
  }

  void read_digits(Decimal& out, bool fraction) {
    for (; position_ < text_.size() && is_digit(text_[position_]); ++position_) {
      const int digit = text_[position_] - '0';
      const bool kept = kept_ < max_digits;
      if (kept) {
        out.digits = times_ten_plus(out.digits, digit);
        if (kept_ > 0 || digit != 0) {
          ++kept_;
        }
      }
      out.exponent += (kept ? 0 : 1) - (fraction ? 1 : 0);
    }
  }

  bool read_exponent(Decimal& out) {
    if (!take('e') && !take('E')) {
      return true;
    }
    const bool negative = take('-');
    if (!negative) {
      take('+');
    }
    const std::size_t before = position_;
    int exponent = 0;
    for (; position_ < text_.size() && is_digit(text_[position_]); ++position_) {
      exponent = std::min(exponent * 10 + (text_[position_] - '0'), 9999);
    }
    out.exponent += negative ? -exponent : exponent;
    return position_ > before;
  }

  std::string_view text_;
  std::size_t position_ = 0;
  int kept_ = 0;
};

} // namespace

Expected<Frequency> Frequency::parse(std::string_view decimal_hz) {
  Decimal decimal;
  std::string quoted = "'";
  quoted.append(decimal_hz.substr(0, 64)).append("'");
  if (!DecimalReader(decimal_hz).read(decimal)) {
    return fail(ErrorCode::invalid_argument,
                "the frequency " + quoted + " is not a decimal number; write hertz such as 12.5");
  }
  // Outside of this range neither a sample rate nor the arithmetic could follow.
  const bool zero = decimal.digits.high == 0.0;
  const double magnitude = zero ? 0.0 : std::log10(decimal.digits.high) + decimal.exponent;
  if (zero || decimal.negative || magnitude < -12.0 || magnitude > 12.0) {
    return fail(ErrorCode::frequency_out_of_range,
                "the frequency " + quoted +
                    " Hz must lie between 1e-12 and 1e12; it must be positive");
  }
  const DoubleDouble per_ns = scaled_by_ten(decimal.digits, decimal.exponent - 9);
  return Frequency(per_ns.high, per_ns.low);
}

Frequency Frequency::from_hz(double hz) {
  const DoubleDouble per_ns = divided({hz, 0.0}, {1e9, 0.0});
  return {per_ns.high, per_ns.low};
}

Frequency Frequency::shifted_by_hz(double delta_hz) const {
  const DoubleDouble delta = divided({delta_hz, 0.0}, {1e9, 0.0});
  const double sum = high_ + delta.high;
  const double part = sum - high_;
  const double error = (high_ - (sum - part)) + (delta.high - part);
  const DoubleDouble result = normalised(sum, error + low_ + delta.low);
  return {result.high, result.low};
}

Frequency Frequency::multiple(int order) const {
  const DoubleDouble result = times({high_, low_}, {static_cast<double>(order), 0.0});
  return {result.high, result.low};
}

double Frequency::hz() const {
  return std::fma(high_, 1e9, low_ * 1e9);
}

double Frequency::angular() const {
  return 2.0 * std::numbers::pi * hz();
}

double Frequency::reduced_turns(std::int64_t dt_ns) const {
  // Two parts of 32 bits, each exact in a double, so that any int64 difference is served.
  constexpr std::int64_t step = std::int64_t{1} << 32;
  const double parts[2] = {static_cast<double>(dt_ns / step) * static_cast<double>(step),
                           static_cast<double>(dt_ns % step)};
  double turns = 0.0;
  double rest = 0.0;
  for (const double dt : parts) {
    const double product = dt * high_;
    rest += std::fma(dt, high_, -product) + dt * low_;
    turns += product - std::nearbyint(product);
  }
  turns += rest;
  return turns - std::nearbyint(turns);
}

} // namespace dyncal::analysis
