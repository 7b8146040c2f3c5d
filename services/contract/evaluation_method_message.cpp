#include "services/contract/evaluation_method_message.hpp"

namespace dyncal::inline contract {

wire::Method to_wire(EvaluationMethod method) {
  switch (method) {
  case EvaluationMethod::analogue:
    return wire::METHOD_ANALOGUE;
  case EvaluationMethod::series_timestamping:
    return wire::METHOD_SERIES_TIMESTAMPING;
  case EvaluationMethod::absolute_time:
    return wire::METHOD_ABSOLUTE_TIME;
  case EvaluationMethod::sample_timestamping:
    break;
  }
  return wire::METHOD_SAMPLE_TIMESTAMPING;
}

std::optional<EvaluationMethod> from_wire(wire::Method method) {
  switch (method) {
  case wire::METHOD_ANALOGUE:
    return EvaluationMethod::analogue;
  case wire::METHOD_SERIES_TIMESTAMPING:
    return EvaluationMethod::series_timestamping;
  case wire::METHOD_ABSOLUTE_TIME:
    return EvaluationMethod::absolute_time;
  case wire::METHOD_SAMPLE_TIMESTAMPING:
    return EvaluationMethod::sample_timestamping;
  }
  return std::nullopt;
}

} // namespace dyncal::inline contract
