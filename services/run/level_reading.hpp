// Whether a window of the reference's samples shows the level of the excitation, and which.
//
// The level A is the amplitude of the sine of the step's frequency (channel_level.hpp). It is one
// only if both halves of the window show it within the agreement asked for, and if the channel
// shows more at this frequency than beside it:
//
//   A / sqrt 2 >= sqrt(s^2 - A^2 / 2),   s: standard deviation of the samples (channel_level.hpp:
//                                        of a displacement, those without slow motion)
//
// A reference that hums, or whose exciter is off, shows a little at any frequency: a loop that
// raised the voltage for that would drive without end. Hum at the frequency itself cannot be told
// from motion here; the level while the output is off shows it (level_meter.hpp).
//
// Fails: device, where more samples are at an end of the range that the channel's description
// states than a sound signal has: it shows less than there is. Plain functions; any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "analysis/base/frequency.hpp"
#include "services/base/error.hpp"
#include "services/evaluation/record/channel_level.hpp"
#include "services/evaluation/record/source_record.hpp"

namespace dyncal::inline run {

struct LevelReading {
  std::optional<double> level_m_s2{};
  SineOfPart sine{};     // of the window, where there is a level
  std::string lacking{}; // why there is none, where the samples tell
};

// Fails (device) where the samples of the window are at an end of the range, as above. REQUIRES, as
// the next: the record is described, and has this channel.
[[nodiscard]] Expected<void> check_range(const SourceRecord& record, std::size_t channel,
                                         const TimeInterval& window);
[[nodiscard]] Expected<LevelReading> read_level(const SourceRecord& record, std::size_t channel,
                                                const TimeInterval& window,
                                                const analysis::Frequency& frequency,
                                                double agreement_rel);

} // namespace dyncal::inline run
