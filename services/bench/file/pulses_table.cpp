#include "services/bench/file/pulses_table.hpp"

namespace dyncal::inline bench {

std::optional<drivers::pps::PulseSettings> read_pulses(TomlTable& source) {
  using Edge = analysis::SampledPulses::Edge;
  auto table = source.table("pulses");
  if (!table) {
    return std::nullopt;
  }
  constexpr double longest_delay_s = 0.1;
  drivers::pps::PulseSettings pulses;
  pulses.channel = table->required_text("channel");
  pulses.edge = table->one_of("edge", {"rising", "falling"}, "rising") == "rising" ? Edge::rising
                                                                                   : Edge::falling;
  pulses.delay_s = table->number("delay_s", 0.0, "s");
  if (pulses.delay_s < -longest_delay_s || pulses.delay_s > longest_delay_s) {
    table->refuse("delay_s", "must be between -0.1 and 0.1 s: of cable and receiver");
  }
  if (!table->has("u_delay_s")) {
    table->refuse("u_delay_s", "is missing: the standard uncertainty of the pulses at the input, "
                               "in s; receivers state some 50 ns");
  }
  pulses.u_delay_s = table->number("u_delay_s", 0.0, "s");
  if (table->has("u_delay_s") && !(pulses.u_delay_s > 0.0)) {
    table->refuse("u_delay_s", "must be positive, in s: no pulse is exact");
  }
  table->finish();
  return pulses;
}

} // namespace dyncal::inline bench
