#include "arrays.hpp"

#include <nanobind/stl/string.h>

namespace dyncal::python {

std::string describe(nb::handle object) {
  if (nb::hasattr(object, "dtype") && nb::hasattr(object, "ndim") && nb::hasattr(object, "flags")) {
    const nb::object element = object.attr("dtype");
    const std::string type = nb::cast<std::string>(nb::str(element));
    const int dimensions = nb::cast<int>(object.attr("ndim"));
    const nb::object is_contiguous = object.attr("flags")["C_CONTIGUOUS"];
    const bool contiguous = PyObject_IsTrue(is_contiguous.ptr()) == 1;
    return "an array of " + type + " with " + std::to_string(dimensions) +
           (dimensions == 1 ? " dimension" : " dimensions") +
           (contiguous ? "" : " that is not contiguous");
  }
  return "of type " + nb::cast<std::string>(object.type().attr("__name__"));
}

} // namespace dyncal::python
