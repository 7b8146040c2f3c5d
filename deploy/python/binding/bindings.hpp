// The parts of the module, one a theme; each adds its types and functions. Types first: what a
// function returns must be known before its signature is written.
#pragma once

#include <nanobind/nanobind.h>

namespace dyncal::python {

void bind_sines(nanobind::module_& module);
void bind_uncertainty(nanobind::module_& module);
void bind_channels(nanobind::module_& module);
void bind_instruments(nanobind::module_& module);
void bind_methods(nanobind::module_& module);
void bind_repetitions(nanobind::module_& module);
void bind_series(nanobind::module_& module);
void bind_responses(nanobind::module_& module);
void bind_clocks(nanobind::module_& module);
void bind_interferometer(nanobind::module_& module);

} // namespace dyncal::python
