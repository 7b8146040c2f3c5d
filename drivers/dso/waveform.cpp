#include "drivers/dso/waveform.hpp"

#include <cmath>

#include "drivers/link/scpi_answer.hpp"

namespace dyncal::drivers::dso {
namespace {

constexpr std::size_t field_count = 10;
constexpr double max_points = 5e8; // the deepest memory of the known families

bool whole_and_positive(double value) {
  return value >= 1.0 && value <= max_points && value == std::floor(value);
}

} // namespace

Expected<Preamble> parse_preamble(std::string_view answer) {
  const auto malformed = [answer](const char* why) {
    return fail(ErrorCode::malformed, "the preamble '" + shown(answer) + "' " + why);
  };
  const auto fields = parse_scpi_numbers(answer);
  if (!fields || fields->size() != field_count) {
    return malformed("does not consist of ten numbers");
  }
  if ((*fields)[0] != 0.0) {
    return malformed("does not announce bytes (format BYTE)");
  }
  if (!whole_and_positive((*fields)[2])) {
    return malformed("announces an impossible number of points");
  }
  if (!((*fields)[4] > 0.0) || !((*fields)[7] > 0.0)) {
    return malformed("has an increment that is not positive");
  }
  Preamble preamble;
  preamble.points = static_cast<std::size_t>((*fields)[2]);
  preamble.x_increment_s = (*fields)[4];
  preamble.x_origin_s = (*fields)[5];
  preamble.x_reference = (*fields)[6];
  preamble.y_increment_v = (*fields)[7];
  preamble.y_origin = (*fields)[8];
  preamble.y_reference = (*fields)[9];
  return preamble;
}

void append_volts(const Preamble& preamble, VoltageRule rule, std::span<const char> codes,
                  std::vector<double>& volts) {
  for (const char byte : codes) {
    const double code = static_cast<unsigned char>(byte);
    volts.push_back(rule == VoltageRule::rigol
                        ? (code - preamble.y_origin - preamble.y_reference) * preamble.y_increment_v
                        : (code - preamble.y_reference) * preamble.y_increment_v +
                              preamble.y_origin);
  }
}

} // namespace dyncal::drivers::dso
