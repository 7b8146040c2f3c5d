// The services of a laboratory for a test: source programs and an analysis service on the test's
// own DDS domain. A service that start() returns is there: runs give up soon on one that is still
// loading.
#pragma once

#include <filesystem>
#include <fstream>
#include <list>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"
#include "tests/system/program_run.hpp"

namespace dyncal::tests {

inline nlohmann::json read_json(const std::filesystem::path& path) {
  std::ifstream stream(path);
  return nlohmann::json::parse(stream, nullptr, false);
}

// Records of a virtual bench as files, the same at every call: acs.csv, dau.csv, truth.json,
// adc.json and a bench file that plays them.
inline std::filesystem::path recorded_bench(const std::filesystem::path& folder,
                                            const std::string& bench, const std::string& seed) {
  ProgramRun record("dyncal-virtual-bench",
                    {"--preset",
                     "mpu9250-ptb",
                     "--seed",
                     seed,
                     "--record-csv",
                     folder,
                     "--truth",
                     folder / "truth.json",
                     "--adc-file",
                     folder / "adc.json",
                     "--frequencies",
                     "20,80,160",
                     "--levels",
                     "10,100,100",
                     "--repetitions",
                     "2",
                     "--settling",
                     "0.5",
                     "--duration-per-step",
                     "2.0"},
                    folder);
  EXPECT_EQ(record.wait(patience), 0) << record.errors();
  std::filesystem::path file = folder / "bench.toml";
  std::ofstream(file) << "bench = \"" << bench << R"("
[excitation]
frequencies_hz = ["20", "80", "160"]
level = [10.0, 100.0, 100.0]
repetitions = 2
settling_s = 0.5
duration_s = 1.5
[sources.dau]
driver = "file"
path = "dau.csv"
units = { acceleration_x = "m/s^2", acceleration_y = "m/s^2", acceleration_z = "m/s^2", sync = "V" }
[sources.acs]
driver = "file"
path = "acs.csv"
units = { reference = "m/s^2", sync = "V" }
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_x", "dau/acceleration_y", "dau/acceleration_z"]
[corrections]
adc = { file = "adc.json", channel = "ADC1" }
[uncertainty]
reference_magnitude_rel = 5e-4
reference_phase_rad = 5e-4
acs_delay_s = 1e-8
)";
  return file;
}

class Laboratory {
public:
  explicit Laboratory(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // Starts a program and returns it, a service as soon as it is there; it lives as long as the
  // laboratory.
  ProgramRun& start(const std::string& program, std::vector<std::string> arguments,
                    const std::string& dds) {
    arguments.insert(arguments.end(), {"--domain", std::to_string(own_dds_domain()), "--dds", dds});
    const std::filesystem::path place =
        folder_ / (program + "-" + std::to_string(services_.size()));
    std::filesystem::create_directories(place);
    ProgramRun& run = services_.emplace_back(program, arguments, place);
    if (const std::string ready = line_when_ready(program); !ready.empty()) {
      EXPECT_TRUE(run.wait_for_error_text(ready, patience)) << program << ": " << run.errors();
    }
    return run;
  }

private:
  static std::string line_when_ready(const std::string& program) {
    if (program == "dyncal-analysis") {
      return "analysis ready";
    }
    if (program == "dyncal-dau") {
      return "listening at UDP";
    }
    if (program == "dyncal-dso") {
      return "is ready";
    }
    if (program == "dyncal-recorder") {
      return "recorder ready";
    }
    if (program == "dyncal-web") {
      return "web ready";
    }
    if (program == "dyncal-guard") {
      return "guarding the output";
    }
    return program == "dyncal" ? "" : ", source ";
  }

  std::filesystem::path folder_;
  std::list<ProgramRun> services_;
};

} // namespace dyncal::tests
