// The implementations of Method, for make_method(); what each of them does stands in its source
// file. A step that cannot be evaluated gives results that are not valid and name the reason. The
// same samples give the same bits.
#pragma once

#include "services/evaluation/method/method.hpp"

namespace dyncal::inline evaluation {

[[nodiscard]] std::unique_ptr<Method> make_absolute_time(std::shared_ptr<const Recipe> recipe);
[[nodiscard]] std::unique_ptr<Method> make_analogue(std::shared_ptr<const Recipe> recipe);
[[nodiscard]] std::unique_ptr<Method>
make_multisine_time_stamping(std::shared_ptr<const Recipe> recipe);
[[nodiscard]] std::unique_ptr<Method>
make_own_clock_sample_stamping(std::shared_ptr<const Recipe> recipe);
[[nodiscard]] std::unique_ptr<Method>
make_sample_time_stamping(std::shared_ptr<const Recipe> recipe);
[[nodiscard]] std::unique_ptr<Method>
make_table_sample_stamping(std::shared_ptr<const Recipe> recipe);

} // namespace dyncal::inline evaluation
