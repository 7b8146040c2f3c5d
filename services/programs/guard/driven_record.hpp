// What a guard keeps of the run that drives its generator, so that a guard that starts after a
// power cut of both hosts knows what to switch off: a file of the state directory for each bench.
//
//   {"generator": "192.0.2.7:5025", "run": "r1", "has_ended": false, "is_conducted": true,
//    "settings": [{"frequency_hz": 40.0, "voltage_vpp": 0.8}],
//    "participant": "0110...", "measurement_link": {"number": 7, "link": "5e88..."},
//    "excitation_link": {"number": 12, "link": "9f86..."}}
//
// The participant and the latest links of the run's conductor (believed_conductor.hpp) are those
// from when the rest was written: any later link goes on from there.
//
// The state directory is systemd's ($STATE_DIRECTORY), else $XDG_STATE_HOME/dyncal-guard, else
// ~/.local/state/dyncal-guard. A file that is damaged or names another generator counts as none.
// Writing fails as write_output_file() does. One thread a bench.
#pragma once

#include <filesystem>
#include <string>

#include "services/programs/guard/believed_conductor.hpp"
#include "services/programs/guard/exciter_watch.hpp"

namespace dyncal::inline programs {

[[nodiscard]] std::filesystem::path guard_state_folder();

class DrivenRecord {
public:
  DrivenRecord(const std::filesystem::path& folder, const std::string& bench,
               std::string generator);

  [[nodiscard]] DrivenRun read() const;
  // Of the run that read() gives.
  [[nodiscard]] Conductor read_conductor() const;
  // A run without a name: nothing is driven any more, and the file goes. A conductor of another run
  // is left out.
  [[nodiscard]] Expected<void> write(const DrivenRun& run, const Conductor& conductor = {}) const;

private:
  std::filesystem::path path_;
  std::string generator_;
};

} // namespace dyncal::inline programs
