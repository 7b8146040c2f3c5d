#include "failure.hpp"

#include <nanobind/stl/string.h>

namespace dyncal::python {
namespace {

namespace nb = nanobind;

// The names of analysis/base/error.hpp: `code` of an exception.
const char* name_of(analysis::ErrorCode code) {
  using analysis::ErrorCode;
  switch (code) {
  case ErrorCode::too_few_samples:
    return "too_few_samples";
  case ErrorCode::not_finite:
    return "not_finite";
  case ErrorCode::stamps_not_increasing:
    return "stamps_not_increasing";
  case ErrorCode::no_excitation:
    return "no_excitation";
  case ErrorCode::frequency_out_of_range:
    return "frequency_out_of_range";
  case ErrorCode::ill_conditioned:
    return "ill_conditioned";
  case ErrorCode::not_converged:
    return "not_converged";
  case ErrorCode::out_of_calibration:
    return "out_of_calibration";
  case ErrorCode::invalid_argument:
    return "invalid_argument";
  }
  return "invalid_argument";
}

} // namespace

void bind_failure() {
  nb::register_exception_translator([](const std::exception_ptr& thrown, void* /*nothing*/) {
    try {
      std::rethrow_exception(thrown);
    } catch (const Failed& failed) {
      // Looked up late: dyncal/__init__.py imports this module first.
      const nb::object type = nb::module_::import_("dyncal.errors").attr("Error");
      const nb::object error = type(name_of(failed.error.code), failed.error.message);
      PyErr_SetObject(type.ptr(), error.ptr());
    }
  });
}

} // namespace dyncal::python
