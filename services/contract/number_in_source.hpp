// The number of a message within its source's session, by which it is recognised when it comes
// again, and from which gaps are found (idl/README.md, "Who was away"). Plain functions, any
// thread.
#pragma once

#include <cstdint>

#include "idl/dyncal.h"

namespace dyncal::inline contract {

[[nodiscard]] inline std::uint64_t number_in_source(const wire::SampleBlock& block) {
  return block.block();
}
// 0: of a message without a shot, which has no number.
[[nodiscard]] inline std::uint64_t number_in_source(const wire::TriggeredRecord& record) {
  return record.shot();
}

// Of a session's first message: one that begins with a later number has lost its beginning.
[[nodiscard]] constexpr std::uint64_t first_number(const wire::SampleBlock& /*type*/) {
  return 0;
}
[[nodiscard]] constexpr std::uint64_t first_number(const wire::TriggeredRecord& /*type*/) {
  return 1;
}

} // namespace dyncal::inline contract
