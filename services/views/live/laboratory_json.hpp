// The state of a laboratory as JSON, for pages and programs (services/programs/web/PROTOCOL.md
// describes each member): SI units, null for what is not known, counters as texts where doubles do
// not hold them, instants as milliseconds since 1970 UTC.
//
// Texts are as the network brought them: write them with json_text() (services/base/json_text.hpp),
// which replaces what is not UTF-8. Plain functions; the thread of the laboratory.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "services/network/bus_state.hpp"

namespace dyncal::inline views::live {

// Benches, programs and events.
[[nodiscard]] nlohmann::ordered_json laboratory_json(const network::BusState& laboratory);
// What the laboratory shows of one bench.
[[nodiscard]] nlohmann::ordered_json bench_tile_json(const network::BusState& laboratory,
                                                     const network::Bench& bench);
// The tile, and with it sources, plan and messages.
[[nodiscard]] nlohmann::ordered_json bench_json(const network::BusState& laboratory,
                                                const network::Bench& bench);

} // namespace dyncal::inline views::live
