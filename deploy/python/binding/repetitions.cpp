// One value from repeated measurements: analysis/method/repetitions.hpp.
#include <string>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/stl/complex.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "analysis/method/repetitions.hpp"
#include "bindings.hpp"
#include "failure.hpp"

namespace dyncal::python {
namespace {

namespace nb = nanobind;
using namespace nb::literals;
using analysis::RepeatedFrequency;
using analysis::Repetition;
using analysis::RepetitionMean;

// One that fails fails the call: the sentence says at which frequency.
std::vector<RepetitionMean> means(const std::vector<RepeatedFrequency>& frequencies) {
  auto outcomes = analysis::means_of_repetitions(frequencies);
  std::vector<RepetitionMean> means;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (!outcomes[i]) {
      const auto& error = outcomes[i].error();
      throw Failed(
          {error.code, std::to_string(frequencies[i].frequency_hz) + " Hz: " + error.message});
    }
    means.push_back(*std::move(outcomes[i]));
  }
  return means;
}

} // namespace

void bind_repetitions(nb::module_& module) {
  nb::class_<Repetition>(module, "Repetition",
                         "One measurement of a frequency, its budget divided into what is drawn\n"
                         "anew and what repeats. Source: analysis/method/repetitions.hpp")
      .def_rw("sweep", &Repetition::sweep, "which sweep over the frequencies it is of; 0: unknown")
      .def_ro("h", &Repetition::h)
      .def_ro("u_random_magnitude_rel", &Repetition::u_random_magnitude_rel)
      .def_ro("u_random_phase_rad", &Repetition::u_random_phase_rad)
      .def_ro("u_common_magnitude_rel", &Repetition::u_common_magnitude_rel)
      .def_ro("u_common_phase_rad", &Repetition::u_common_phase_rad);
  module.def(
      "make_repetition",
      [](std::complex<double> h, const std::vector<analysis::Contribution>& budget,
         std::uint32_t sweep) {
        Repetition repetition = analysis::make_repetition(h, budget);
        repetition.sweep = sweep;
        return repetition;
      },
      "h"_a, "budget"_a, "sweep"_a = 0,
      "A repetition of a point: make_repetition(point.h, point.budget).\n"
      "Source: analysis/method/repetitions.hpp");
  nb::class_<RepetitionMean>(module, "RepetitionMean",
                             "u_magnitude and u_phase_rad are U / 2, so that the factor 2 covers\n"
                             "95.45 % although repetitions are few; magnitude_rel and phase have\n"
                             "u (k = 1), nu_eff and k. Source: analysis/method/repetitions.hpp")
      .def_ro("h", &RepetitionMean::h)
      .def_ro("magnitude", &RepetitionMean::magnitude)
      .def_ro("u_magnitude", &RepetitionMean::u_magnitude, "U / 2")
      .def_ro("phase_rad", &RepetitionMean::phase_rad, "lead, (-pi, pi]")
      .def_ro("u_phase_rad", &RepetitionMean::u_phase_rad, "U / 2")
      .def_ro("u_independent_phase_rad", &RepetitionMean::u_independent_phase_rad,
              "U / 2 without what repeats: for the group delay")
      .def_ro("scatter_magnitude", &RepetitionMean::scatter_magnitude, "s of one repetition")
      .def_ro("scatter_phase_rad", &RepetitionMean::scatter_phase_rad)
      .def_ro("repetitions", &RepetitionMean::repetitions)
      .def_ro("polarity_differs", &RepetitionMean::polarity_differs)
      .def_ro("magnitude_rel", &RepetitionMean::magnitude_rel)
      .def_ro("phase", &RepetitionMean::phase)
      .def_ro("independent_phase", &RepetitionMean::independent_phase);
  nb::class_<RepeatedFrequency>(
      module, "RepeatedFrequency",
      "All repetitions of one frequency, in Hz. Source: analysis/method/repetitions.hpp")
      .def(
          "__init__",
          [](RepeatedFrequency* self, double frequency_hz,
             const std::vector<Repetition>& repetitions) {
            new (self) RepeatedFrequency{frequency_hz, repetitions};
          },
          "frequency_hz"_a, "repetitions"_a)
      .def_ro("frequency_hz", &RepeatedFrequency::frequency_hz)
      .def_ro("repetitions", &RepeatedFrequency::repetitions);
  module.def("means_of_repetitions", &means, "frequencies"_a,
             "Means of all frequencies of one channel that were measured in one session, which\n"
             "together say how much runs scatter.\n"
             "\n"
             "Raises Error (invalid_argument, not_finite).\n"
             "Source: analysis/method/repetitions.hpp, analysis/uncertainty/random_effects.hpp");
}

} // namespace dyncal::python
