// The contract's TransferFunction: made from a transfer function where it leaves, read where it
// comes in. Plain functions, any thread.
#pragma once

#include "idl/dyncal.h"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/result/transfer_function.hpp"

namespace dyncal::services {

[[nodiscard]] wire::TransferFunction to_message(const Recipe& recipe,
                                                const TransferFunction& function);
// A mean has what the message carries of it: not u_independent_phase_rad nor its coverage factors.
[[nodiscard]] TransferFunction from_message(const wire::TransferFunction& message);

} // namespace dyncal::services
