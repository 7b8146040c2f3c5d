// What kind of device a source is, and with it the topic and the form of its samples: SampleBlocks,
// or TriggeredRecords of sources that record after a trigger. Any thread.
#pragma once

#include "idl/dyncal.h"

namespace dyncal::inline contract {

enum class SourceKind {
  dau, // a digital acquisition unit: sensors with digital output and time stamps
  acs, // an analogue calibration system
  dso, // a digital storage oscilloscope, triggered
  tss, // a time series sensor, triggered
  can  // a sensor on CAN
};

// As result files spell it: "dau".
[[nodiscard]] const char* to_string(SourceKind kind);

[[nodiscard]] wire::SourceKind to_wire(SourceKind kind);
// A value of a later contract reads as acs.
[[nodiscard]] SourceKind from_wire(wire::SourceKind kind);

[[nodiscard]] bool is_triggered(SourceKind kind);

// The topic on which a source of this kind publishes its samples.
[[nodiscard]] const char* sample_topic(SourceKind kind);

} // namespace dyncal::inline contract
