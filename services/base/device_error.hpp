// What a driver reports, as an error of a program: the sentence as it is. Any thread.
#pragma once

#include "drivers/error.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline base {

[[nodiscard]] inline Error device_error(const drivers::Error& error) {
  return {ErrorCode::device, error.message};
}

} // namespace dyncal::inline base
