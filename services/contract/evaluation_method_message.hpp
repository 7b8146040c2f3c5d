// The evaluation method as the contract's messages carry it. Plain functions, any thread.
#pragma once

#include <optional>

#include "idl/dyncal.h"
#include "services/contract/evaluation_method.hpp"

namespace dyncal::inline contract {

[[nodiscard]] wire::Method to_wire(EvaluationMethod method);
// Nothing for a value of a later contract.
[[nodiscard]] std::optional<EvaluationMethod> from_wire(wire::Method method);

} // namespace dyncal::inline contract
