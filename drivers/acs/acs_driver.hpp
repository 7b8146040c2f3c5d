// An analogue calibration system (ACS) as a source of samples: its description, then blocks of
// samples into a sink.
//
// Two implementations: SocketAcs (the instrument's TCP stream, README.md) and FileSource (a
// recorded series; any other kind of source may be played from a file too). Values are in the units
// of the description, stamps as in drivers/sample_block.hpp. Order of calls: describe() once, run()
// once. One thread calls both; stop() may come from any thread, at any time.
#pragma once

#include "drivers/error.hpp"
#include "drivers/sample_block.hpp"

namespace dyncal::drivers::acs {

// Where the samples go. Called from the thread that runs the driver.
class BlockSink {
public:
  virtual ~BlockSink() = default;
  // Sample numbers begin anew: first call before the first block, again whenever an instrument that
  // had gone is back.
  virtual void begin_session(const SourceDescription& description) = 0;
  // May wait for room: nothing is lost by it, the driver reads on afterwards (a TCP stream and a
  // file both wait).
  virtual void take(SampleBlock block) = 0;
};

class AcsDriver {
public:
  virtual ~AcsDriver() = default;
  // Connects to the instrument or opens the file, and says what it will deliver.
  [[nodiscard]] virtual Expected<SourceDescription> describe() = 0;
  // Delivers until the end of the stream or stop(); both are success. REQUIRES: describe() has
  // succeeded.
  [[nodiscard]] virtual Expected<void> run(BlockSink& sink) = 0;
  virtual void stop() = 0;
};

} // namespace dyncal::drivers::acs
