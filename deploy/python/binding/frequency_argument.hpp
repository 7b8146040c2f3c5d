// A frequency as Python gives it: decimal text ("79.98", which keeps its digits), a number (the
// double itself), or a Frequency that came out of a fit. Units: Hz. Refused with a sentence:
// frequency_out_of_range, invalid_argument.
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include "analysis/base/frequency.hpp"
#include "failure.hpp"

namespace dyncal::python {

namespace nb = nanobind;

struct FrequencyArgument {
  nb::object object;

  [[nodiscard]] analysis::Frequency frequency() const {
    if (nb::isinstance<nb::str>(object)) {
      return value_of(analysis::Frequency::parse(nb::cast<std::string>(object)));
    }
    if (nb::isinstance<analysis::Frequency>(object)) {
      return nb::cast<analysis::Frequency>(object);
    }
    double hz = 0.0;
    if (!nb::try_cast(object, hz)) {
      refuse("the frequency must be a text such as \"79.98\", a number in hertz, or a Frequency");
    }
    if (!std::isfinite(hz) || hz <= 0.0) {
      throw Failed({analysis::ErrorCode::frequency_out_of_range,
                    "the frequency must be finite and positive"});
    }
    return analysis::Frequency::from_hz(hz);
  }
};

} // namespace dyncal::python

// NOLINTBEGIN(readability-identifier-naming): as nanobind calls them.
namespace nanobind::detail {

template <>
struct type_caster<dyncal::python::FrequencyArgument> {
  NB_TYPE_CASTER(dyncal::python::FrequencyArgument, const_name("str | float | Frequency"))

  bool from_python(handle source, std::uint32_t /*flags*/, cleanup_list* /*cleanup*/) noexcept {
    value = {borrow(source)};
    return true;
  }
  static handle from_cpp(const dyncal::python::FrequencyArgument& argument, rv_policy /*policy*/,
                         cleanup_list* /*cleanup*/) noexcept {
    return argument.object.inc_ref();
  }
};

} // namespace nanobind::detail
// NOLINTEND(readability-identifier-naming)
