// What an operator should know of the signals of an interferometer while they run: each in one
// sentence, once as long as it lasts, and again only after ten seconds without it. No
// synchronisation.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "drivers/interferometer/quadrature_demodulator.hpp"
#include "drivers/sample_sink.hpp"

namespace dyncal::drivers::interferometer {

class SignalComplaints {
public:
  // `pair`: "u1 and u2", for the sentences.
  SignalComplaints(std::string pair, double rate_hz) : pair_(std::move(pair)), rate_hz_(rate_hz) {}

  // After every block, of so many pairs.
  void look(QuadratureDemodulator& demodulator, std::size_t pairs, SampleSink& sink);

private:
  enum Subject { not_measured, clipped, without_beam, doubtful, slow, other_radius, no_ellipse };
  static constexpr std::size_t subjects = no_ellipse + 1;

  // Whether it is to be said.
  bool is_new(Subject subject);
  void look_at_counts(const DemodulationCounts& now, SampleSink& sink);
  void look_at_radius(QuadratureDemodulator& demodulator, SampleSink& sink);

  std::string pair_;
  double rate_hz_;
  double now_s_ = 0.0;
  double radius_since_s_ = 0.0;
  double without_ellipse_since_s_ = 0.0;
  DemodulationCounts before_;
  std::array<double, subjects> last_s_ = {-1e9, -1e9, -1e9, -1e9, -1e9, -1e9, -1e9};
};

} // namespace dyncal::drivers::interferometer
