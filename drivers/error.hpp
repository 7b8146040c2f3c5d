// What can go wrong between a driver and its device, as a value.
//
// `message` is one sentence for the person at the bench: what, where (file, line, address, key) and
// what to do about it.
//
// Drivers return tl::expected<T, Error> and log nothing. They throw nothing but what the standard
// library throws when memory or descriptors run out.
#pragma once

#include "analysis/base/failure.hpp"

namespace dyncal::drivers {

enum class ErrorCode {
  not_found,    // the file, device, port, channel or sensor does not exist
  refused,      // the device or the system declines (permission, address in use, instrument error)
  timeout,      // nothing came within the time allowed
  malformed,    // what came cannot be understood
  disconnected, // the device was there and has gone
  invalid_setting // the caller asked for something impossible
};

using Error = Failure<ErrorCode>;

template <class T>
using Expected = tl::expected<T, Error>;

} // namespace dyncal::drivers
