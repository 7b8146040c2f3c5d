#include "services/contract/evaluation_method_message.hpp"

#include "services/base/per_enumerator.hpp"

namespace dyncal::inline contract {

wire::Method to_wire(EvaluationMethod method) {
  return per_enumerator(method, {wire::METHOD_ANALOGUE, wire::METHOD_SAMPLE_TIMESTAMPING,
                                 wire::METHOD_SERIES_TIMESTAMPING, wire::METHOD_ABSOLUTE_TIME});
}

std::optional<EvaluationMethod> from_wire(wire::Method method) {
  using Known = std::optional<EvaluationMethod>;
  return per_enumerator<wire::Method, Known>(
      method,
      {EvaluationMethod::analogue, EvaluationMethod::sample_timestamping,
       EvaluationMethod::series_timestamping, EvaluationMethod::absolute_time},
      std::nullopt);
}

} // namespace dyncal::inline contract
