// Daemons tell systemd that they serve, and that their main loops turn.
#include <csignal>
#include <fstream>
#include <string>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/daemon/supervision/metrics_server.hpp"
#include "services/daemon/supervision/service_manager.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"
#include "tests/system/program_run.hpp"
#include "tests/system/test_folder.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/udp_port.hpp"
#include "tests/unit/services/daemon/supervision/notify_socket.hpp"
#include "tests/unit/services/daemon/supervision/scrape.hpp"

namespace dyncal::tests {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr auto watchdog = 1s; // four signs in it, the loops turn twice a second at least

class SupervisionTest : public ::testing::Test {
protected:
  void SetUp() override {
    if (!daemon::can_notify_service_manager()) {
      GTEST_SKIP() << "this build has no libsystemd";
    }
  }

  ProgramRun start(const std::string& program, std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--domain", std::to_string(own_dds_domain())});
    return {program, arguments, output_};
  }
  std::string bench_file(const std::string& source) const {
    return folder_.write("bench.toml", R"(bench = "supervised"
[excitation]
frequencies_hz = ["10"]
level = 1.0
[sources.acs]
)" + source + R"(
[method]
kind = "analogue"
reference = "acs/reference"
dut = ["acs/dut"]
)");
  }
  std::string next_sign() {
    return socket_.next(std::chrono::duration_cast<std::chrono::milliseconds>(patience));
  }
  void expect_a_watched_program(ProgramRun& program, const std::string& status) {
    const std::string ready = next_sign();
    ASSERT_THAT(ready, HasSubstr("READY=1")) << program.errors();
    EXPECT_THAT(ready, HasSubstr("STATUS=" + status));
    for (int sign = 0; sign < 3; ++sign) {
      EXPECT_EQ(next_sign(), "WATCHDOG=1");
    }
    program.send(SIGSTOP);
    while (socket_.next(0ms) == "WATCHDOG=1") { // those that were on their way
    }
    EXPECT_EQ(socket_.next(2 * watchdog), "") << "a program that hangs sends no sign";
    program.send(SIGCONT);
    EXPECT_EQ(next_sign(), "WATCHDOG=1");
    program.send(SIGTERM);
    std::string sign = next_sign();
    while (sign == "WATCHDOG=1") {
      sign = next_sign();
    }
    EXPECT_EQ(sign, "STOPPING=1");
    EXPECT_EQ(program.wait(patience), 0) << program.errors();
  }

  TemporaryFolder folder_;
  std::filesystem::path output_ = fresh_folder_of_this_test();
  NotifySocket socket_{folder_.path().string(), watchdog};
};

TEST_F(SupervisionTest, ShowsThatTheAnalysisServes) {
  ProgramRun program = start("dyncal-analysis", {});
  expect_a_watched_program(program, "cyclonedds on analysis@");
}

TEST_F(SupervisionTest, ShowsThatASourceServes) {
  const std::string record =
      folder_.write("record.csv", "t_ns,reference,dut\n0,0,0\n1000000,1,1\n2000000,0,0\n");
  ProgramRun program = start("dyncal-acs", {bench_file("driver = \"file\"\npath = \"" + record +
                                                       "\"\nunits = { reference = \"m/s^2\", "
                                                       "dut = \"V\" }\n")});
  expect_a_watched_program(program, "bench supervised");
}

TEST_F(SupervisionTest, ShowsThatAGuardServes) {
  ProgramRun program = start("dyncal-guard", {bench_file("driver = \"socket\"\n"
                                                         "address = \"127.0.0.1:1\"\n"
                                                         "[generator]\ndriver = \"scpi\"\n"
                                                         "address = \"127.0.0.1:1\"\n"
                                                         "level_per_volt = 1.0\n")});
  expect_a_watched_program(program, "bench supervised");
}

TEST_F(SupervisionTest, OffersMetricsAndRefusesAPortThatIsInUse) {
  if (!daemon::can_serve_metrics()) {
    GTEST_SKIP() << "this build has no prometheus-cpp";
  }
  const int port = own_udp_port();
  const std::string address = "127.0.0.1:" + std::to_string(port);
  ProgramRun analysis = start("dyncal-analysis", {"--metrics", address});
  ASSERT_THAT(next_sign(), HasSubstr("READY=1")) << analysis.errors();
  const auto values = metrics_in(fetch_metrics(port));
  ASSERT_TRUE(values.contains(R"(dyncal_analysis_runs{state="armed"})")) << fetch_metrics(port);
  EXPECT_EQ(values.at(R"(dyncal_analysis_runs{state="armed"})"), 0);
  EXPECT_EQ(values.at("dyncal_malformed_messages_total"), 0);
  EXPECT_GT(values.at("process_resident_memory_bytes"), 1e6);
  ProgramRun second("dyncal-analysis",
                    {"--metrics", address, "--domain", std::to_string(own_dds_domain())},
                    fresh_folder("supervision_second"));
  EXPECT_EQ(second.wait(patience), 1);
  EXPECT_THAT(second.errors(), HasSubstr("--metrics " + address +
                                         ": cannot listen there (Address "
                                         "already in use)"));
  analysis.send(SIGTERM);
  EXPECT_EQ(analysis.wait(patience), 0) << analysis.errors();
}

TEST_F(SupervisionTest, IsNotReadyWithoutItsInstrument) {
  ProgramRun program = start("dyncal-acs", {bench_file("driver = \"socket\"\n"
                                                       "address = \"127.0.0.1:1\"\n")});
  EXPECT_EQ(program.wait(patience), 1) << program.errors();
  for (std::string sign = socket_.next(); !sign.empty(); sign = socket_.next()) {
    EXPECT_THAT(sign, ::testing::Not(HasSubstr("READY")));
  }
}

} // namespace
} // namespace dyncal::tests
