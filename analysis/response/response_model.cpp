#include "analysis/response/response_model.hpp"

#include <numbers>

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;

struct KindRow {
  ResponseKind kind;
  std::string_view text;
  std::string_view name;
  bool delay, first_order, second_order;
};

// In the order of the enumeration.
constexpr std::array kinds{
    KindRow{ResponseKind::gain, "gain", "gain", false, false, false},
    KindRow{ResponseKind::delay, "delay", "delay", true, false, false},
    KindRow{ResponseKind::first_order, "first order", "first_order", false, true, false},
    KindRow{ResponseKind::first_order_with_delay, "first order with delay",
            "first_order_with_delay", true, true, false},
    KindRow{ResponseKind::second_order, "second order", "second_order", false, false, true},
    KindRow{ResponseKind::second_order_with_delay, "second order with delay",
            "second_order_with_delay", true, false, true},
    KindRow{ResponseKind::second_and_first_order_with_delay, "second and first order with delay",
            "second_and_first_order_with_delay", true, true, true}};

const KindRow& row_of(ResponseKind kind) {
  return kinds[static_cast<std::size_t>(kind)];
}

} // namespace

std::complex<double> response_at(const ResponseParameters& parameters, double frequency_hz) {
  std::complex<double> h =
      parameters.gain * std::polar(1.0, -2.0 * pi * frequency_hz * parameters.delay_s);
  if (parameters.corner_hz > 0.0) {
    h /= std::complex<double>(1.0, frequency_hz / parameters.corner_hz);
  }
  if (parameters.resonance_hz > 0.0) {
    const double ratio = frequency_hz / parameters.resonance_hz;
    h /= std::complex<double>(1.0 - ratio * ratio, 2.0 * parameters.damping * ratio);
  }
  return h;
}

std::string_view to_string(ResponseKind kind) {
  return row_of(kind).text;
}
std::string_view name_of(ResponseKind kind) {
  return row_of(kind).name;
}
bool has_delay(ResponseKind kind) {
  return row_of(kind).delay;
}
bool has_first_order(ResponseKind kind) {
  return row_of(kind).first_order;
}
bool has_second_order(ResponseKind kind) {
  return row_of(kind).second_order;
}
std::size_t parameter_count(ResponseKind kind) {
  return 1 + (has_delay(kind) ? 1 : 0) + (has_first_order(kind) ? 1 : 0) +
         (has_second_order(kind) ? 2 : 0);
}

std::vector<std::complex<double>> log_slopes(ResponseKind kind, const ResponseParameters& p,
                                             double frequency_hz) {
  std::vector<std::complex<double>> slopes{1.0 / p.gain};
  if (has_delay(kind)) {
    slopes.emplace_back(0.0, -2.0 * pi * frequency_hz);
  }
  if (has_first_order(kind)) {
    const std::complex<double> turned(0.0, frequency_hz / p.corner_hz);
    slopes.push_back(turned / (1.0 + turned) / p.corner_hz);
  }
  if (has_second_order(kind)) {
    const double ratio = frequency_hz / p.resonance_hz;
    const std::complex<double> denominator(1.0 - ratio * ratio, 2.0 * p.damping * ratio);
    slopes.push_back(std::complex<double>(-2.0 * ratio * ratio, 2.0 * p.damping * ratio) /
                     denominator / p.resonance_hz);
    slopes.push_back(std::complex<double>(0.0, -2.0 * ratio) / denominator);
  }
  return slopes;
}

} // namespace dyncal::analysis
