// What can go wrong in a program of dyncal, as a value, and the exit status that goes with it.
//
// `message` is one sentence for the user: what, where (file, line, key, source, service) and what
// to do about it.
#pragma once

#include <optional>

#include "analysis/base/failure.hpp"

namespace dyncal::inline base {

enum class ErrorCode {
  bad_file,     // a file is missing, unreadable or holds a value that is not valid
  bad_argument, // an option of the command line is not valid
  no_source,    // a source is missing, silent, or lacks a channel
  no_analysis,  // no analysis service answers, or it refuses the recipe
  device,       // a driver reports an error
  network,      // DDS cannot be used as asked
  interrupted,  // the user stopped it
  no_result     // the run ended without what it was for
};

using Error = Failure<ErrorCode>;

template <class T>
using Expected = tl::expected<T, Error>;

// Of calls that were all made before the first outcome was looked at; nothing if none failed.
template <class... T>
[[nodiscard]] std::optional<Error> first_error(const Expected<T>&... outcomes) {
  std::optional<Error> first;
  const auto look = [&first](const auto& outcome) {
    if (!first && !outcome) {
      first = outcome.error();
    }
  };
  (look(outcomes), ...);
  return first;
}

} // namespace dyncal::inline base
