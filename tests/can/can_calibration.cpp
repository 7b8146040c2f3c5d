#include "tests/can/can_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <random>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "drivers/can/time/frame_duration.hpp"

namespace dyncal::tests {

namespace {

double phase_difference_rad(const nlohmann::json& a, const nlohmann::json& b) {
  return std::remainder(a["phase_rad"].get<double>() - b["phase_rad"].get<double>(),
                        2 * std::numbers::pi);
}

} // namespace

const std::vector<Bus>& calibrated_buses() {
  static const std::vector<Bus> buses = {
      {"500k", {500e3, 0.0}, false}, {"1M", {1e6, 0.0}, false}, {"fd-5M", {1e6, 5e6}, true}};
  return buses;
}

std::string bus_name(const Bus& bus) {
  std::string name = "at_" + bus.name;
  std::erase(name, '-');
  return name;
}

double mean_frame_s(const Bus& bus) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> reading(-2000, 2000);
  double sum_s = 0.0;
  constexpr int frames = 2000;
  for (int k = 0; k < frames; ++k) {
    CanFrame frame;
    frame.id = 0x100;
    frame.fd = frame.bit_rate_switch = bus.fd;
    frame.length = bus.fd ? 24 : 8;
    const int values[] = {reading(random) / 40, reading(random) / 40, 1961 + reading(random),
                          k * 31};
    for (std::size_t i = 0; i < 4; ++i) {
      frame.data[2 * i] = static_cast<std::uint8_t>(values[i]);
      frame.data[2 * i + 1] = static_cast<std::uint8_t>(values[i] >> 8);
    }
    sum_s += drivers::can::frame_duration_s(frame, bus.rates);
  }
  return sum_s / frames;
}

// On a virtual interface the virtual sensor makes the bus's time itself. A machine that leaves it
// no time for that, so that a tenth of its frames is late, says nothing about what receives them.
bool starved(const std::string& said) {
  unsigned long long all = 0;
  unsigned long long late = 0;
  unsigned long long sent = 0;
  const std::size_t at = said.rfind("dyncal-virtual-bench: ");
  if (at == std::string::npos ||
      std::sscanf(said.c_str() + at,
                  "dyncal-virtual-bench: %llu frames on vcan0, %llu of the %llu of the sensor late",
                  &all, &late, &sent) != 3) {
    return false;
  }
  std::printf("%llu frames, %llu of the %llu of the sensor late\n", all, late, sent);
  if (10 * late <= sent) {
    return false;
  }
  std::printf("skipped: this machine was too busy to keep the time of a bus: %llu of %llu frames "
              "were late\n",
              late, sent);
  return true;
}

CanCalibration::CanCalibration(const std::string& test, const Bus& bus)
    : bus_(bus), folder_(fresh_folder(test + "_" + bus.name)) {
  const std::vector<std::pair<std::string, std::string>> options = {
      {"--preset", "mpu9250-ptb"},
      {"--can", "vcan0"},
      {"--can-bus", bus.name},
      {"--can-load", "0.05"},
      {"--acs-rate", "5000"},
      {"--frequencies", "10,40,104"},
      {"--levels", "10,30,100"},
      {"--reference-magnitude-rel", "5e-4"},
      {"--reference-phase-rad", "5e-4"},
      {"--truth", folder_ / "truth.json"},
      {"--ports-file", folder_ / "ports.json"},
      {"--dbc-file", folder_ / "sensor.dbc"},
      {"--dau", "127.0.0.1:9"}};
  std::vector<std::string> arguments;
  for (const auto& [option, value] : options) {
    arguments.push_back(option);
    arguments.push_back(value);
  }
  bench_.emplace("dyncal-virtual-bench", arguments, folder_);
  EXPECT_TRUE(bench_->wait_for_error_text("ports", patience)) << bench_->errors();
}

void CanCalibration::add_source(const std::string& name, const std::string& interface_name,
                                const std::string& settings) {
  sources_.emplace_back(name, fmt::format("[sources.{}]\ndriver = \"can\"\ninterface = \"{}\"\ndbc "
                                          "= \"sensor.dbc\"\ncounter = \"counter\"\n"
                                          "nominal_rate_hz = 500.0\nu_utc_s = 1e-7\n{}\n",
                                          name, interface_name, settings));
}

void CanCalibration::write_bench_file(const std::vector<std::string>& channels) const {
  const nlohmann::json ports = read_json(folder_ / "ports.json");
  std::ofstream file(folder_ / "bench.toml");
  file << fmt::format(
      "bench = \"can-{}\"\n[excitation]\nfrequencies_hz = [\"10\", \"40\", \"104\"]\nlevel = [10, "
      "30, 100]\n"
      "settling_s = 0.5\nduration_s = 1.5\n[generator]\ndriver = \"scpi\"\naddress = "
      "\"127.0.0.1:{}\"\n"
      "level_per_volt = 50.0\n[sources.acs]\ndriver = \"socket\"\naddress = \"127.0.0.1:{}\"\n",
      bus_.name, ports["generator"].get<int>(), ports["acs"].get<int>());
  for (const auto& [name, section] : sources_) {
    file << section;
  }
  file << fmt::format("[method]\nkind = \"absolute-time\"\nreference = \"acs/reference\"\nsync_acs "
                      "= \"acs/sync\"\ndut = [\"{}\"]\n"
                      "[uncertainty]\nreference_magnitude_rel = 5e-4\nreference_phase_rad = "
                      "5e-4\nacs_delay_s = 1e-7\n",
                      fmt::join(channels, "\", \""));
}

bool CanCalibration::bench_was_starved() {
  bench_->send(SIGTERM);
  EXPECT_TRUE(bench_->wait(patience));
  return starved(bench_->errors());
}

void CanCalibration::kill_and_restart(Laboratory& services, ProgramRun& can,
                                      const std::string& file, const SourceKill& kill) {
  std::this_thread::sleep_for(kill.after); // the drawn instant
  can.send(SIGKILL);
  EXPECT_TRUE(can.wait(patience));
  std::this_thread::sleep_for(kill.away); // drawn as well
  services.start("dyncal-can", {file}, "cyclonedds");
}

std::optional<CanCalibration::Points> CanCalibration::run(const std::vector<std::string>& channels,
                                                          const std::optional<SourceKill>& kill) {
  write_bench_file(channels);
  const std::string file = folder_ / "bench.toml";
  Laboratory services(folder_);
  services.start("dyncal-analysis", {}, "cyclonedds");
  ProgramRun& can = services.start("dyncal-can", {file}, "cyclonedds");
  for (const auto& [name, section] : sources_) {
    EXPECT_TRUE(can.wait_for_error_text("source " + name, patience)) << can.errors();
  }
  services.start("dyncal-acs", {file}, "cyclonedds");
  if (testing::Test::HasFailure()) { // on a starved guest services may not even get to load
    return bench_was_starved() ? std::nullopt : std::optional(Points{});
  }
  ProgramRun run("dyncal",
                 {"run", file, "--output", folder_ / "result.json", "--dds", "cyclonedds",
                  "--domain", std::to_string(own_dds_domain())},
                 folder_);
  if (kill) {
    kill_and_restart(services, can, file, *kill);
  }
  const auto status = run.wait(patience);
  if (bench_was_starved()) {
    return std::nullopt;
  }
  EXPECT_EQ(status, 0) << run.errors() << can.errors();
  Points points;
  const nlohmann::json result = read_json(folder_ / "result.json");
  for (const auto& point : result["transfer_function"]) {
    points[{point["channel"], fmt::format("{:g}", point["frequency_hz"].get<double>())}] = point;
  }
  return points;
}

void CanCalibration::expect_whole(std::size_t channels) const {
  const nlohmann::json result = read_json(folder_ / "result.json");
  EXPECT_EQ(result["points"].size(), 3 * channels); // of three frequencies
  for (const auto& point : result["points"]) {
    EXPECT_TRUE(point["valid"].get<bool>()) << point["problem"];
    EXPECT_EQ(point["lost"], 0) << point;
    EXPECT_EQ(point["flags"], nlohmann::json::array()) << point;
  }
}

void CanCalibration::expect_truth(const Points& points, const std::string& source,
                                  double max_in_u) const {
  double worst_in_u = 0.0;
  int compared = 0;
  const nlohmann::json all = read_json(folder_ / "truth.json");
  for (const auto& truth : all["transfer_function"]) {
    const std::string frequency_hz = truth["frequency_text_hz"];
    const auto found =
        points.find({source + "/" + truth["channel"].get<std::string>(), frequency_hz});
    ASSERT_NE(found, points.end()) << truth;
    const nlohmann::json& value = found->second;
    const double phase_error_rad = phase_difference_rad(value, truth);
    const double magnitude_error =
        value["magnitude"].get<double>() - truth["magnitude"].get<double>();
    const double u_phase_rad = value["u_phase_rad"];
    const double u_magnitude = value["u_magnitude"];
    worst_in_u = std::max({worst_in_u, std::abs(phase_error_rad) / u_phase_rad,
                           std::abs(magnitude_error) / u_magnitude});
    compared += 2;
    if (truth["channel"] == "acceleration_z") {
      std::printf(
          "%s, %s, %s Hz: magnitude %+.5f (u %.5f), phase %+.3f mrad (u %.3f), that is %+.1f us\n",
          bus_.name.c_str(), source.c_str(), frequency_hz.c_str(), magnitude_error, u_magnitude,
          phase_error_rad * 1e3, u_phase_rad * 1e3,
          phase_error_rad / (2 * std::numbers::pi * truth["frequency_hz"].get<double>()) * 1e6);
    }
  }
  EXPECT_EQ(compared, 18);
  EXPECT_LT(worst_in_u, max_in_u) << source;
}

void CanCalibration::expect_late_by_a_frame(const Points& points, const std::string& corrected,
                                            const std::string& uncorrected) const {
  const double frame_s = mean_frame_s(bus_);
  for (const std::string frequency_hz : {"10", "40", "104"}) {
    // Stamps that are late make the sensor seem to lag.
    const double expected_rad = -2 * std::numbers::pi * std::stod(frequency_hz) * frame_s;
    const double difference_rad =
        phase_difference_rad(points.at({uncorrected + "/acceleration_z", frequency_hz}),
                             points.at({corrected + "/acceleration_z", frequency_hz}));
    EXPECT_NEAR(difference_rad, expected_rad, 0.03 * std::abs(expected_rad))
        << frequency_hz << " Hz";
    std::printf("%s, %s Hz: without frame duration %+.2f mrad, expected %+.2f mrad (%.1f us)\n",
                bus_.name.c_str(), frequency_hz.c_str(), difference_rad * 1e3, expected_rad * 1e3,
                frame_s * 1e6);
  }
}

} // namespace dyncal::tests
