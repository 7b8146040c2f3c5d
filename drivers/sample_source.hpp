// A source of samples that is opened, describes itself, and then delivers into a sink until it
// ends: an instrument's stream (drivers/acs) or a recorded series (drivers/files).
//
// Order of calls: describe() once, run() once. Values are in the units of the description, stamps
// as in drivers/sample_block.hpp. One thread calls both; stop() may come from any thread, at any
// time.
#pragma once

#include "drivers/error.hpp"
#include "drivers/sample_block.hpp"
#include "drivers/sample_sink.hpp"

namespace dyncal::drivers {

class SampleSource {
public:
  virtual ~SampleSource() = default;
  // Connects to the instrument or opens the file, and reports what it will deliver.
  [[nodiscard]] virtual Expected<SourceDescription> describe() = 0;
  // Delivers until the end of the stream or stop(); both are success. Every session begins with
  // begin_session() and describe(). REQUIRES: describe() has succeeded.
  [[nodiscard]] virtual Expected<void> run(SampleSink& sink) = 0;
  virtual void stop() = 0;
};

} // namespace dyncal::drivers
