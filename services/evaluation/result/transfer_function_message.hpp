// The contract's TransferFunction: made from a transfer function where it leaves, read where it
// comes in. Plain functions, any thread.
#pragma once

#include "idl/dyncal.h"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/transfer_function.hpp"

namespace dyncal::inline evaluation {

[[nodiscard]] wire::TransferFunction to_message(const Recipe& recipe,
                                                const TransferFunction& function);
// Without the unwrapped phases of the group delay, which stand in the points. Of a message by an
// older writer, a mean has k = 2 with infinite degrees of freedom.
[[nodiscard]] TransferFunction from_message(const wire::TransferFunction& message);

} // namespace dyncal::inline evaluation
