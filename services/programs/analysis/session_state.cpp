#include "services/programs/analysis/session_state.hpp"

#include <algorithm>

namespace dyncal::inline programs {

bool Arming::is_over(const MissingSource& missing, bus::Clock::Instant now) {
  if (missing.is_there && now - since <= present_limit) {
    starting = missing.is_starting ? now : starting;
    return false;
  }
  return now - std::max(since, starting) > limit || missing.is_starting;
}

wire::ArmState arm_of(const SessionState& state) {
  if (const auto* ended = std::get_if<Ended>(&state)) {
    return ended->arm;
  }
  if (const auto* failed = std::get_if<Failed>(&state)) {
    return failed->was_armed ? wire::ARM_ARMED : wire::ARM_WAITING;
  }
  return std::holds_alternative<Arming>(state) ? wire::ARM_WAITING : wire::ARM_ARMED;
}

wire::HealthState health_of(const SessionState& state) {
  if (const auto* ended = std::get_if<Ended>(&state)) {
    return ended->health;
  }
  if (std::holds_alternative<Failed>(state)) {
    return wire::HEALTH_FAILED;
  }
  const bool waits =
      std::holds_alternative<TakingOver>(state) || std::holds_alternative<Held>(state);
  return waits ? wire::HEALTH_WAITING : wire::HEALTH_OK;
}

bus::Clock::Instant waits_since(const SessionState& state, bus::Clock::Instant now) {
  if (const auto* takeover = std::get_if<TakingOver>(&state)) {
    return takeover->all_there;
  }
  const auto* held = std::get_if<Held>(&state);
  return held != nullptr ? held->since : now;
}

} // namespace dyncal::inline programs
