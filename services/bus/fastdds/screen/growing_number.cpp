#include "services/bus/fastdds/screen/growing_number.hpp"

namespace dyncal::bus {

GrowingNumber::Kind GrowingNumber::judge(std::int64_t number, std::int64_t max_step) {
  const std::int64_t step = number - newest_;
  if (!agreed_) {
    agreed_ = newest_ >= 0 && step >= 0 && step <= max_step;
    newest_ = number;
    return Kind::newer;
  }
  if (step <= 0) {
    return Kind::known;
  }
  if (step > max_step) {
    const bool goes_on =
        doubtful_in_a_row_ > 0 && number >= doubtful_ && number - doubtful_ <= max_step_of_doubtful;
    doubtful_in_a_row_ = goes_on ? doubtful_in_a_row_ + 1 : 1;
    doubtful_ = number;
    if (doubtful_in_a_row_ < sure_after) {
      return Kind::implausible;
    }
  }
  newest_ = number;
  doubtful_in_a_row_ = 0;
  return Kind::newer;
}

} // namespace dyncal::bus
