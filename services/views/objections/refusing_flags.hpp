// Which flags of a result forbid a certificate, and why: the one place that decides it.
//
// A flag forbids when the value may be wrong by more than its U, when U lacks a contribution, or
// when the measurement was not the one that the certificate would state. What only made U larger,
// or is stated beside the value, does not. Plain functions, any thread.
#pragma once

#include <string>
#include <string_view>

#include "services/evaluation/result/result_flag.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

struct FlagVerdict {
  bool forbids = true;
  std::string_view reason;
  bool of_phase_alone = false; // the magnitude beside it may be believed
};

[[nodiscard]] FlagVerdict verdict_on(ResultFlag flag);
// The name of the first such flag of the magnitude or phase of a mean, of its channel or of its
// repetitions; empty: none.
[[nodiscard]] std::string doubting_flag(const StoredResult& result, const StoredValue& value,
                                        bool of_phase);

} // namespace dyncal::inline views
