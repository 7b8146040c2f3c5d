// dyncal-can as people run it, on a USB adapter: what does not fit the interface is one line and an
// exit status that is not 0; what happens to the adapter is said and survived.
#include <csignal>
#include <fstream>
#include <sstream>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/can/gs_usb_adapter.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"
#include "tests/system/program_run.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

class CanProgram : public testing::Test {
protected:
  void SetUp() override {
    std::ofstream(folder / "sensor.dbc")
        << "BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (0.01,0) [0|0] \"m/s^2\" S\n";
    std::ofstream(folder / "acs.csv") << "t_ns,reference,sync\n0,1,2\n100000,1,2\n200000,1,2\n";
  }

  [[nodiscard]] std::vector<std::string> arguments(const std::string& settings) const {
    std::ofstream(folder / "bench.toml")
        << fmt::format("bench = \"b\"\n[excitation]\nfrequencies_hz = [\"80\"]\nlevel = "
                       "10.0\n[sources.acs]\ndriver = \"file\"\npath = \"acs.csv\"\n"
                       "[sources.can]\ndriver = \"can\"\ninterface = \"{}\"\ndbc = "
                       "\"sensor.dbc\"\nu_utc_s = 1e-6\n{}\n"
                       "[method]\nkind = \"absolute-time\"\nreference = "
                       "\"acs/reference\"\nsync_acs = \"acs/sync\"\ndut = [\"can/x\"]\n",
                       adapter.name(0), settings);
    return {folder / "bench.toml", "--domain", std::to_string(own_dds_domain()), "--dds",
            "cyclonedds"};
  }

  // The one line that does not come from the log.
  std::string failure(const std::string& settings) {
    ProgramRun run("dyncal-can", arguments(settings), folder);
    const auto status = run.wait(patience);
    EXPECT_TRUE(status) << "dyncal-can has not ended";
    EXPECT_NE(status.value_or(0), 0);
    std::istringstream said(run.errors());
    std::vector<std::string> lines;
    for (std::string line; std::getline(said, line);) {
      if (line.starts_with("dyncal-can: ")) {
        lines.push_back(line);
      }
    }
    EXPECT_EQ(lines.size(), 1U) << run.errors();
    return lines.empty() ? "" : lines.front();
  }

  const std::filesystem::path folder = fresh_folder(
      std::string("can-program-") + testing::UnitTest::GetInstance()->current_test_info()->name());
  GsUsbAdapter adapter{GsUsbSettings{}};
};

TEST_F(CanProgram, NamesFileSourceInterfaceAndBothRatesWhereTheBitRateIsAnother) {
  adapter.set_up(0, "bitrate 1000000 dbitrate 5000000 fd on");
  EXPECT_THAT(failure("bit_rate_per_s = 500000"),
              MatchesRegex("dyncal-can: .*/bench.toml:[0-9]+: source 'can': interface 'can0' runs "
                           "at a bit rate of 1000000 bit/s, the bench "
                           "file says 500000; change one of them"));
  EXPECT_THAT(failure("bit_rate_per_s = 1000000\ndata_bit_rate_per_s = 2000000"),
              HasSubstr("interface 'can0' runs at a data bit rate of 5000000 bit/s, the bench file "
                        "says 2000000; change one of them"));
}

TEST_F(CanProgram, SaysHowAnInterfaceIsSetUpThatIsDown) {
  EXPECT_THAT(
      failure(""),
      HasSubstr(
          "interface 'can0' is down; 'ip link set can0 up type can bitrate 500000' sets it up"));
}

TEST_F(CanProgram, GoesOnWhenTheAdapterIsPulledOutAndPluggedIn) {
  adapter.set_up(0, "bitrate 1000000");
  ProgramRun run("dyncal-can", arguments(""), folder);
  ASSERT_TRUE(run.wait_for_error_text("source can", patience)) << run.errors();
  adapter.unplug();
  ASSERT_TRUE(run.wait_for_error_text("interface 'can0' has gone", patience)) << run.errors();
  adapter.plug_in();
  adapter.set_up(0, "bitrate 1000000");
  ASSERT_TRUE(run.wait_for_error_text("interface 'can0' is up", patience)) << run.errors();
  run.send(SIGTERM);
  EXPECT_EQ(run.wait(patience), 0) << run.errors();
}

} // namespace
} // namespace dyncal::tests
