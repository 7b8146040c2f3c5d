// The services of a laboratory for a test: source programs and an analysis service on a DDS domain
// of the test's own.
#pragma once

#include <filesystem>
#include <fstream>
#include <list>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

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
  EXPECT_EQ(record.wait(std::chrono::seconds(60)), 0) << record.errors();
  const std::filesystem::path file = folder / "bench.toml";
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
)";
  return file;
}

class Laboratory {
public:
  Laboratory(std::filesystem::path folder, int domain)
      : folder_(std::move(folder)), domain_(std::to_string(domain)) {}

  // Starts a service and returns it; it lives as long as the laboratory.
  ProgramRun& start(const std::string& program, std::vector<std::string> arguments,
                    const std::string& dds) {
    arguments.insert(arguments.end(), {"--domain", domain_, "--dds", dds});
    const std::filesystem::path place =
        folder_ / (program + "-" + std::to_string(services_.size()));
    std::filesystem::create_directories(place);
    return services_.emplace_back(program, arguments, place);
  }

private:
  std::filesystem::path folder_;
  std::string domain_;
  std::list<ProgramRun> services_;
};

} // namespace dyncal::tests
