// How much of a laboratory is held at most, whatever is written on the bus. Plain data; any thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace dyncal::network {

// Nothing was heard of a bench or a source for longer: it is silent. Sources and services report
// every second; a page that asks in turn still shows it within 3 s.
inline constexpr std::chrono::milliseconds silence_limit{2500};
// A conductor repeats its Measurement every 2 s.
inline constexpr std::chrono::seconds conductor_limit{5};
inline constexpr std::chrono::seconds gone_limit{60};
// Samples that were lost less than this ago are a warning.
inline constexpr std::chrono::seconds loss_limit{30};

struct Limits {
  std::size_t benches = 64;
  std::size_t sources = 32;            // of a bench
  std::size_t services = 16;           // of a bench: analyses, recorders, guards
  std::size_t runs = 8;                // of a bench
  std::size_t results_of_run = 4096;   // channels times steps
  std::size_t results = 16'384;        // of all benches
  std::size_t channels = 64;           // of a source; transfer functions of a run
  std::size_t settings_bytes = 65'536; // of a source; of longer ones nothing is known
  std::size_t steps = 4096;            // of a plan
  std::size_t rows = 1024;             // of any other list within a message
  std::size_t events = 200;            // of a bench
};

// What had no room.
struct LeftOut {
  std::uint64_t benches = 0;  // messages of benches that are not held
  std::uint64_t sources = 0;  // messages, and sources that made way
  std::uint64_t services = 0; // likewise
  std::uint64_t runs = 0;     // that were dropped or not taken
  std::uint64_t results = 0;
};

} // namespace dyncal::network
