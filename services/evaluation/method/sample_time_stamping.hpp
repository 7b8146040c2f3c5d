// The DAU stamps every sample of the sensor and of sync; sync links its clock to that of the ACS:
// sample time stamping, paper eqs. (1), (3), (4) (analysis/method/sample_stamping.hpp).
//
// Without channels under calibration in the recipe, all channels of the DAU but sync and
// temperature are. The response of the DAU's sync ADC is corrected by the recipe's calibration; a
// step that cannot be evaluated gives results that are not valid and name the reason. The same
// samples give the same bits.
#pragma once

#include "analysis/base/error.hpp"
#include "services/evaluation/method/method.hpp"

namespace dyncal::inline evaluation {

class SampleTimeStamping : public Method {
public:
  explicit SampleTimeStamping(std::shared_ptr<const Recipe> recipe)
      : recipe_(std::move(recipe)), roles_(std::get<SampleStampingRoles>(recipe_->roles)) {}

  [[nodiscard]] std::vector<SearchedChannel> searches() const override;
  [[nodiscard]] Evaluation evaluation(std::size_t step, const RunRecords& records) override;
  [[nodiscard]] std::optional<std::string> clock_source() const override {
    return roles_.sync_dau.source;
  }

private:
  std::shared_ptr<const Recipe> recipe_;
  const SampleStampingRoles& roles_;
};

} // namespace dyncal::inline evaluation
