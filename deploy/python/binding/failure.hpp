// Errors of the library as the Python exception dyncal.Error, with the code and the sentence.
//
// `value_of(outcome)` gives the value of an Expected or throws Failed, which the module translates
// (bind_failure). The GIL is not needed to throw.
#pragma once

#include <exception>
#include <string>
#include <utility>

#include <nanobind/nanobind.h>

#include "analysis/base/error.hpp"

namespace dyncal::python {

struct Failed : std::exception {
  explicit Failed(analysis::Error failure) : error(std::move(failure)) {}
  [[nodiscard]] const char* what() const noexcept override { return error.message.c_str(); }
  analysis::Error error;
};

[[noreturn]] inline void refuse(std::string sentence) {
  throw Failed({analysis::ErrorCode::invalid_argument, std::move(sentence)});
}

template <class T>
T value_of(analysis::Expected<T> outcome) {
  if (!outcome) {
    throw Failed(std::move(outcome).error());
  }
  if constexpr (!std::is_void_v<T>) {
    return *std::move(outcome);
  }
}

void bind_failure();

} // namespace dyncal::python
