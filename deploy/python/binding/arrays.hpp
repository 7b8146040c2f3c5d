// numpy arrays as spans, without a copy, and vectors as numpy arrays, without a copy.
//
// Array<T> accepts any Python object, so that what it refuses it refuses with a sentence of its
// own: spans are taken of one-dimensional, contiguous arrays of exactly T (int64 stamps, float64
// values), read-only ones too. Nothing is converted: a copy of 10^7 samples that nobody asked for
// is a mistake, and float stamps of today's nanoseconds have lost their last 8 bits.
//
// The span lives as long as the Array. Hold the GIL to make one; reading needs none.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "failure.hpp"

namespace dyncal::python {

namespace nb = nanobind;

template <class T>
constexpr const char* element_name() {
  if constexpr (std::is_same_v<T, double>) {
    return "float64";
  } else if constexpr (std::is_same_v<T, float>) {
    return "float32";
  } else if constexpr (std::is_same_v<T, std::int64_t>) {
    return "int64";
  } else if constexpr (std::is_same_v<T, std::int16_t>) {
    return "int16";
  } else {
    static_assert(std::is_same_v<T, std::uint8_t>);
    return "uint8";
  }
}

// "a list", "an array of float32 with 2 dimensions".
std::string describe(nb::handle object);

template <class T>
class Array {
public:
  Array() = default;
  explicit Array(nb::object object) : object_(std::move(object)) {}

  // `name` is that of the argument, for the sentence.
  [[nodiscard]] std::span<const T> span(const std::string& name) {
    if (!nb::try_cast<Vector>(object_, array_, false)) {
      refuse(name + " is " + describe(object_) + ", but must be a contiguous one-dimensional " +
             "numpy array of " + element_name<T>() + ": nothing is converted unasked; use " +
             "numpy.ascontiguousarray(..., dtype='" + element_name<T>() + "'), or a list of " +
             "one array a channel");
    }
    return {array_.data(), array_.shape(0)};
  }
  [[nodiscard]] const nb::object& object() const { return object_; }

private:
  using Vector = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
  nb::object object_;
  Vector array_; // keeps what the span is of
};

// The values without a copy: numpy owns them from now on.
template <class T>
using NewArray = nb::ndarray<nb::numpy, T, nb::ndim<1>, nb::c_contig>;

template <class T>
NewArray<T> to_numpy(std::vector<T> values) {
  auto* kept = new std::vector<T>(std::move(values)); // of the capsule
  const nb::capsule owner(kept, [](void* gone) noexcept {
    delete static_cast<std::vector<T>*>(gone); // NOLINT(cppcoreguidelines-owning-memory)
  });
  return NewArray<T>(kept->data(), {kept->size()}, owner);
}

// Several channels of one clock: spans, and what keeps them.
struct Columns {
  std::vector<Array<double>> arrays;
  std::vector<std::span<const double>> spans;

  void add(const std::string& name, nb::handle object) {
    arrays.emplace_back(nb::borrow(object));
    spans.push_back(arrays.back().span(name));
  }
};

} // namespace dyncal::python

// NOLINTBEGIN(readability-identifier-naming): as nanobind calls them.
namespace nanobind::detail {

template <class T>
struct type_caster<dyncal::python::Array<T>> {
  static constexpr auto element = const_name<std::is_same_v<T, double>>(
      const_name("float64"), const_name<std::is_same_v<T, std::uint8_t>>("uint8", "int64"));
  NB_TYPE_CASTER(dyncal::python::Array<T>,
                 const_name("numpy.typing.NDArray[numpy.") + element + const_name("]"))

  bool from_python(handle source, std::uint32_t /*flags*/, cleanup_list* /*cleanup*/) noexcept {
    value = dyncal::python::Array<T>(borrow(source));
    return true;
  }
  static handle from_cpp(const dyncal::python::Array<T>& array, rv_policy /*policy*/,
                         cleanup_list* /*cleanup*/) noexcept {
    return array.object().inc_ref();
  }
};

} // namespace nanobind::detail
// NOLINTEND(readability-identifier-naming)
