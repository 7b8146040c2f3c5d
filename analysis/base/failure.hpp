// What every layer's errors have in common: a code of a closed set and one sentence.
//
// Each layer names its own codes (analysis/base/error.hpp, drivers/error.hpp,
// services/base/error.hpp), so that a caller can tell from the type which layer failed. The
// sentence is for the person at the bench: what, where (file, line, key, address) and what to do
// about it. Functions return tl::expected and end in `return fail(code, sentence)`; an error of a
// function that they call they hand on by DYNCAL_TRY. Plain data, any thread.
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

// Goes on with the value of a call, or returns its error as it is:
//
//   DYNCAL_TRY(const auto record, read_record(path)); // declares the value
//   DYNCAL_TRY(settings.rate_hz, read_rate(text));    // assigns it
//   DYNCAL_TRY(write_record(path, record));           // has none, or it is not needed
//   DYNCAL_TRY(outcome);                              // what has a name keeps it, and its value
//
// A statement of its own in a function or lambda whose tl::expected has the same type of error.
// Value and error are moved, those of an outcome with a name copied; what a function gives by
// reference can be declared as one.
//
// Write the block (`if (!outcome) { ... return fail(...); }`) where the sentence needs more words,
// or something is to be undone or said first. Give the outcome a name where the call has a lambda
// of several statements: no debugger steps through the argument of a macro.
// services/decisions/17-errors-handed-on.md has what was refused.
#define DYNCAL_TRY(first, ...)                                                                     \
  DYNCAL_TRY_JOIN(DYNCAL_TRY_OUTCOME, __VA_OPT__(_VALUE))(first __VA_OPT__(, ) __VA_ARGS__)

#define DYNCAL_TRY_JOIN(first, second) DYNCAL_TRY_JOIN_EXPANDED(first, second)
#define DYNCAL_TRY_JOIN_EXPANDED(first, second) first##second

#define DYNCAL_TRY_OUTCOME(call)                                                                   \
  if (auto&& dyncal_outcome = call; !dyncal_outcome) {                                             \
    return ::dyncal::fail(std::forward<decltype(dyncal_outcome)>(dyncal_outcome).error());         \
  }

#define DYNCAL_TRY_OUTCOME_VALUE(declaration, ...)                                                 \
  DYNCAL_TRY_NAMED(DYNCAL_TRY_JOIN(dyncal_outcome_, __LINE__), declaration, __VA_ARGS__)

#define DYNCAL_TRY_NAMED(outcome, declaration, ...)                                                \
  auto&& outcome = __VA_ARGS__;                                                                    \
  if (!outcome) {                                                                                  \
    return ::dyncal::fail(std::forward<decltype(outcome)>(outcome).error());                       \
  }                                                                                                \
  declaration = *std::forward<decltype(outcome)>(outcome)
