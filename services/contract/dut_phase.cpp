#include "services/contract/dut_phase.hpp"

#include <algorithm>
#include <array>

namespace dyncal::inline contract {
namespace {

constexpr std::array<const char*, 4> names{"delay", "delay-from-0", "delay-from-180", "any"};

} // namespace

const char* to_string(DutPhase phase) {
  return names.at(static_cast<std::size_t>(phase));
}

std::optional<DutPhase> parse_dut_phase(std::string_view text) {
  const auto found = std::find(names.begin(), names.end(), text);
  return found == names.end() ? std::nullopt
                              : std::optional(static_cast<DutPhase>(found - names.begin()));
}

} // namespace dyncal::inline contract
