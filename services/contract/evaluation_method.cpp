#include "services/contract/evaluation_method.hpp"

#include <array>

namespace dyncal::inline contract {
namespace {

struct Spelling {
  EvaluationMethod method;
  const char* text;
};

constexpr std::array<Spelling, 4> spellings{{
    {EvaluationMethod::analogue, "analogue"},
    {EvaluationMethod::sample_timestamping, "sample-timestamping"},
    {EvaluationMethod::series_timestamping, "series-timestamping"},
    {EvaluationMethod::absolute_time, "absolute-time"},
}};

} // namespace

const char* to_string(EvaluationMethod method) {
  for (const Spelling& spelling : spellings) {
    if (spelling.method == method) {
      return spelling.text;
    }
  }
  return "";
}

std::optional<EvaluationMethod> parse_evaluation_method(std::string_view text) {
  for (const Spelling& spelling : spellings) {
    if (text == spelling.text) {
      return spelling.method;
    }
  }
  return std::nullopt;
}

} // namespace dyncal::inline contract
