// What every layer's errors have in common: a code of a closed set and one sentence.
//
// Each layer names its own codes (analysis/base/error.hpp, drivers/error.hpp,
// services/base/error.hpp), so that a caller can tell from the type which layer failed. The
// sentence is for the person at the bench: what, where (file, line, key, address) and what to do
// about it. Functions return tl::expected and end in `return fail(code, sentence)`. Plain data, any
// thread.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace dyncal {

template <class Code>
struct Failure {
  Code code;
  std::string message;
};

template <class Code>
[[nodiscard]] tl::unexpected<Failure<Code>> fail(Code code, std::string message) {
  return tl::unexpected(Failure<Code>{code, std::move(message)});
}

// Hands on the error of a function that was called.
template <class Code>
[[nodiscard]] tl::unexpected<Failure<Code>> fail(Failure<Code> failure) {
  return tl::unexpected(std::move(failure));
}

} // namespace dyncal
