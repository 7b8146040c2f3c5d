// Where every sampling driver puts what it has: the description of its source, blocks of samples,
// its account of them, and warnings.
//
// Order of calls: describe() at the latest before the first take() that needs it (a sensor may send
// samples before it has described itself), begin_session() whenever sample numbers start over or
// the columns change, count() about twice a second and at the end.
//
// Nothing here fails: what a sink cannot take it counts itself. Called on the driver's thread, one
// call after the other. A sink of a live device must not block; a sink of a file or a TCP stream
// may, since these wait.
#pragma once

#include <string>

#include "drivers/sample_block.hpp"
#include "drivers/sample_counts.hpp"

namespace dyncal::drivers {

class SampleSink {
public:
  virtual ~SampleSink() = default;

  // Known for the first time, or changed. The columns of the blocks are its channels.
  virtual void describe(const SourceDescription& description) = 0;
  // The blocks that follow have a new numbering or other columns.
  virtual void begin_session() = 0;
  virtual void take(SampleBlock block) = 0;
  // Everything since the driver started; replaces the account before.
  virtual void count(const SampleCounts& counts) = 0;
  // One sentence for a person about something that no count tells.
  virtual void warn(const std::string& sentence) = 0;
};

} // namespace dyncal::drivers
