// dyncal._dyncal: the analysis library in Python. dyncal/__init__.py says what is public.
#include "bindings.hpp"
#include "failure.hpp"

NB_MODULE(_dyncal, module) {
  using namespace dyncal::python;
  module.doc() = "The analysis library of dyncal: see the package dyncal.";
  bind_failure();
  bind_sines(module);
  bind_uncertainty(module);
  bind_channels(module);
  bind_instruments(module);
  bind_methods(module);
  bind_repetitions(module);
  bind_series(module);
  bind_responses(module);
  bind_clocks(module);
  bind_interferometer(module);
}
