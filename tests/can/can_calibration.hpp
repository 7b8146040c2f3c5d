// A whole calibration of the virtual bench's sensor on CAN, by the programs of the build: virtual
// bench on the interface vcan0 -> sources of dyncal-can and dyncal-acs -> DDS -> dyncal-analysis ->
// result of dyncal run, held against the truth of the virtual bench.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "drivers/can/time/frame_duration.hpp"
#include "tests/can/kernel_can.hpp"
#include "tests/system/laboratory.hpp"

namespace dyncal::tests {

struct Bus {
  std::string name; // of the virtual bench
  drivers::can::BitRates rates;
  bool fd = false;
};

[[nodiscard]] const std::vector<Bus>& calibrated_buses();
// For the name of a test.
[[nodiscard]] std::string bus_name(const Bus& bus);

// How long the sensor's frames are on the bus, on average over their contents.
[[nodiscard]] double mean_frame_s(const Bus& bus);

// dyncal-can is killed in a run, and started again.
struct SourceKill {
  std::chrono::duration<double> after; // the start of the run
  std::chrono::duration<double> away;
};

// True, with a line that the test was skipped, when the virtual bench says that it could not keep
// the time of a bus. `said`: at its end.
[[nodiscard]] bool starved(const std::string& said);

class CanCalibration {
public:
  // Measured values by channel ("can/acceleration_z") and frequency ("10").
  using Points = std::map<std::pair<std::string, std::string>, nlohmann::json>;

  // Starts the virtual bench. A test failure when it does not start.
  CanCalibration(const std::string& test, const Bus& bus);

  // A source of the bench file of driver "can" for the virtual bench's sensor; `settings`: further
  // lines of it.
  void add_source(const std::string& name, const std::string& interface_name,
                  const std::string& settings);
  // Calibrates the channels. Nothing when the machine had no time for it.
  [[nodiscard]] std::optional<Points> run(const std::vector<std::string>& channels,
                                          const std::optional<SourceKill>& kill = std::nullopt);

  // Every point is there, valid, without loss and without flag.
  void expect_whole(std::size_t channels) const;

  // All three axes of a source within `max_in_u` of the truth in phase and magnitude, with a line
  // for each frequency of the axis of excitation.
  void expect_truth(const Points& points, const std::string& source, double max_in_u) const;
  // The second source is wrong by the duration of the sensor's frames against the first.
  void expect_late_by_a_frame(const Points& points, const std::string& corrected,
                              const std::string& uncorrected) const;

private:
  // Ends the bench; true if it had no time to keep the time of a bus.
  bool bench_was_starved();
  static void kill_and_restart(Laboratory& services, ProgramRun& can, const std::string& file,
                               const SourceKill& kill);

  void write_bench_file(const std::vector<std::string>& channels) const;

  Bus bus_;
  VirtualCan wire_{"vcan0"};
  std::filesystem::path folder_;
  std::vector<std::pair<std::string, std::string>> sources_; // name, section
  std::optional<ProgramRun> bench_;
};

} // namespace dyncal::tests
