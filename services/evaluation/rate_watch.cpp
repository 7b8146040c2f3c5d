#include "services/evaluation/rate_watch.hpp"

#include <algorithm>

#include <fmt/core.h>

namespace dyncal::inline evaluation {
namespace {

constexpr std::size_t blocks_looked_at = 16;

} // namespace

RateWatch::RateWatch(const Recipe& recipe) : recipe_(recipe) {
  for (const std::string& source :
       {recipe.reference().source, recipe.roles.sync_acs.source, recipe.roles.sync_sensor.source}) {
    unknown_.try_emplace(source);
  }
  for (const ChannelName& channel : recipe.dut()) {
    unknown_.try_emplace(channel.source);
  }
  unknown_.erase(""); // of a role that the method does not have
}

void RateWatch::add(const std::string& source, const SourceBlock& block) {
  const auto found = unknown_.find(source);
  if (found == unknown_.end() || block.samples == 0) {
    return;
  }
  Seen& seen = found->second;
  const std::int64_t stamp_ns = block.first_stamp_ns();
  const bool goes_on = seen.session == block.session && seen.first_sample < block.first_sample &&
                       seen.first_stamp_ns < stamp_ns;
  if (goes_on) {
    seen.rates_hz.push_back(1e9 * static_cast<double>(block.first_sample - seen.first_sample) /
                            static_cast<double>(stamp_ns - seen.first_stamp_ns));
  }
  seen.session = block.session;
  seen.first_sample = block.first_sample;
  seen.first_stamp_ns = stamp_ns;
  if (seen.rates_hz.size() == blocks_looked_at) {
    const auto middle = seen.rates_hz.begin() + blocks_looked_at / 2;
    std::nth_element(seen.rates_hz.begin(), middle, seen.rates_hz.end());
    judge(source, *middle);
    unknown_.erase(found);
  }
}

void RateWatch::judge(const std::string& source, double rate_hz) {
  for (const RecipeStep& step : recipe_.steps) {
    if (!problem_ && step.frequency.hz() >= 0.5 * rate_hz * (1.0 + margin_rel)) {
      problem_ = fmt::format("step {} has {} Hz, but the samples of source '{}' come at {:.4g} Hz "
                             "and show frequencies below {:.4g} Hz only: take the step out of the "
                             "bench file, or set the source to a higher rate",
                             step.step, step.frequency_text_hz, source, rate_hz, 0.5 * rate_hz);
    }
  }
}

} // namespace dyncal::inline evaluation
