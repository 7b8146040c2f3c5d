// Reference and sensors are all stamped in UTC, and no sync is needed: absolute time
// (analysis/method/analogue_comparison.hpp).
//
// A step that cannot be evaluated gives results that are not valid and name the reason. The same
// samples give the same bits.
#pragma once

#include "services/evaluation/method/method.hpp"

namespace dyncal::inline evaluation {

class AbsoluteTime : public Method {
public:
  explicit AbsoluteTime(std::shared_ptr<const Recipe> recipe)
      : recipe_(std::move(recipe)), roles_(std::get<AbsoluteTimeRoles>(recipe_->roles)) {}

  [[nodiscard]] std::vector<SearchedChannel> searches() const override;
  [[nodiscard]] Expected<void> check_time_scales(const RunRecords& records) const override;
  [[nodiscard]] bool is_complete(std::size_t step, const RunRecords& records) const override;
  [[nodiscard]] Evaluation evaluation(std::size_t step, const RunRecords& records) override;
  [[nodiscard]] std::optional<std::string> clock_source() const override {
    return roles_.dut.front().source;
  }

private:
  std::shared_ptr<const Recipe> recipe_;
  const AbsoluteTimeRoles& roles_;
};

} // namespace dyncal::inline evaluation
