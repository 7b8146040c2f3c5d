// What is wrong with a bench on purpose: one description for all its instruments, by channel,
// sensor and exciter. An empty one is a sound bench.
//
// Channels are those of the roles in a bench file: the sensor under calibration, reference and sync
// as the ACS records them, sync as the unit's ADC does. Each may have
//
//   range      end stops at +-range, which its description states, whatever the level
//   soft ends  end stops before the channel's own noise and converter, at one end or both
//   curved     a second order: x + part x^2 / signal, before its soft ends
//   held       samples, drawn one by one, that have the value of the one before
//   stuck      the value of one sample for so many samples, again and again
//   hum        mains: an added sine of constant amplitude, between the steps too, or only while the
//              generator's output is on
//   drift      of the zero: rises from each change of the generator on, while its output is on
//   knock      half a sine of 10 ms, so long after each change of the generator
//
// Hum and drift are in parts of the signal: of the highest level, or of the amplitude of sync.
// The generator may hold what another program left, and keep it, or not switch off. Stamps have
// faults of their own (stamp_faults.hpp), as have datagrams (wire/datagram_path.hpp). Plain data;
// any thread.
#pragma once

#include <cstddef>

#include "drivers/virtual_bench/model/stamp_faults.hpp"

namespace dyncal::drivers::virtual_bench {

struct ChannelFaults {
  double range = 0.0;      // in the channel's unit; 0: one that holds the highest level
  double soft_upper = 0.0; // in the channel's unit; 0: none
  double soft_lower = 0.0; // of the opposite sign
  double second_order_rel = 0.0;
  double held_part = 0.0;
  std::size_t stuck_samples = 0;
  double stuck_every_s = 1.0;
  double hum_rel = 0.0;
  double hum_hz = 50.0;
  bool hum_while_driven = false;
  double drift_rel_per_s = 0.0;
  double knock_rel = 0.0;
  double knock_after_s = 1.0;

  bool operator==(const ChannelFaults&) const = default;
};

// The sensor's filter switches, so long after each change of the generator.
struct DelayChange {
  double by_s = 0.0;
  double after_s = 1.0;
};

// The exciter's amplitude is modulated by a sine.
struct Wandering {
  double part = 0.0;
  double period_s = 1.0;
};

// Of single samples of the sensor; of the ACS, which loses whole frames.
struct SampleLoss {
  double probability = 0.0;
  bool counted = true; // the numbers of the samples go on over those that are lost
};

// When a time series sensor takes the first sample of a series, after the trigger.
struct SeriesStart {
  bool free_running = false; // with its next own sample: uniform over one sample
  double jitter_s = 0.0;     // standard deviation from shot to shot
};

// What another program left in the generator. It is kept for those who ask, and does not act.
struct LeftInGenerator {
  double offset_v = 0.0;
  bool in_burst = false;
  bool is_kept = false; // whatever is reset: commands are taken without an error
};

struct BenchFaults {
  ChannelFaults sensor; // each axis of it
  ChannelFaults reference;
  ChannelFaults sync_acs;
  ChannelFaults sync_dau;
  SampleLoss sensor_loss;
  SampleLoss acs_loss;
  SeriesStart series_start;
  LeftInGenerator left_in_generator;
  StampFaultProbabilities stamps;
  std::size_t fifo_samples = 0; // of the sensor: read so many at once, stamped 10 ns apart
  DelayChange delay_change;
  Wandering wandering;
  double exciter_gain = 1.0;    // times level_per_volt: an amplifier that somebody turned up
  double ring_down_s = 0.0;     // time constant of the exciter after a step; 0: its usual one
  bool output_stays_on = false; // once it was on, although the generator answers that it is off
};

} // namespace dyncal::drivers::virtual_bench
