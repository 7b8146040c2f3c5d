#include "services/contract/triggered_record.hpp"

#include <algorithm>

#include "idl/dyncal.h"

namespace dyncal::inline contract {

TriggeredRecord from_message(const wire::TriggeredRecord& message) {
  return {.session = message.session(),
          .shot = message.shot(),
          .step = message.step(),
          .attempt = std::max(message.attempt(), 1U),
          .samples = message.sample_count(),
          .channels = message.channel_count(),
          .trigger_utc_ns = message.trigger_utc_ns(),
          .first_sample_s = message.first_sample_s(),
          .interval_s = message.interval_s(),
          .values = message.values()};
}

} // namespace dyncal::inline contract
