// Sensor and reference are channels of one system: the analogue method, paper eqs. (1) and (2)
// (analysis/method/analogue_comparison.hpp). Sync beside them, where it is named, shows where the
// steps are and gives the frequency.
//
// A step that cannot be evaluated gives results that are not valid and name the reason. The same
// samples give the same bits.
#pragma once

#include "services/evaluation/method/method.hpp"

namespace dyncal::inline evaluation {

class Analogue : public Method {
public:
  explicit Analogue(std::shared_ptr<const Recipe> recipe)
      : recipe_(std::move(recipe)), roles_(std::get<AnalogueRoles>(recipe_->roles)) {}

  [[nodiscard]] std::vector<SearchedChannel> searches() const override;
  [[nodiscard]] Evaluation evaluation(std::size_t step, const RunRecords& records) override;

private:
  std::shared_ptr<const Recipe> recipe_;
  const AnalogueRoles& roles_;
};

} // namespace dyncal::inline evaluation
