// What does not exist or does not fit gives one clear line and an exit status that is not 0. How
// soon, within ten seconds, run_controller_test.cpp and run_session_test.cpp hold in stepped time.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"
#include "tests/udp_port.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

std::filesystem::path write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
  return path;
}

const std::string bench_text = R"(bench = "broken"
[excitation]
frequencies_hz = ["80"]
level = 10.0
[sources.dau]
driver = "smartup"
listen = "127.0.0.1:0"
sensor = "0xbccb0100"
[sources.acs]
driver = "file"
path = "acs.csv"
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
)";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

class FailureLine : public testing::Test {
protected:
  std::filesystem::path folder = fresh_folder(
      std::string("failure-") + testing::UnitTest::GetInstance()->current_test_info()->name());

  void SetUp() override {
    write(folder / "acs.csv", "t_ns,reference,sync\n0,1,2\n100000,1,2\n200000,1,2\n");
  }

  // Runs the program, expects it to fail in time, and returns the one line that does not come from
  // the log.
  std::string line_of(const std::string& program, std::vector<std::string> arguments) {
    ProgramRun run(program, arguments, folder);
    const auto status = run.wait(patience);
    EXPECT_TRUE(status) << program << " has not ended";
    EXPECT_NE(status.value_or(0), 0);
    std::istringstream stream(run.errors());
    std::string line;
    std::vector<std::string> lines;
    while (std::getline(stream, line)) {
      if (line.starts_with(program + ": ")) {
        lines.push_back(line);
      }
    }
    EXPECT_EQ(lines.size(), 1U) << run.errors();
    return lines.empty() ? "" : lines.front();
  }

  std::string run_line(const std::string& text) {
    return line_of("dyncal", {"run", write(folder / "bench.toml", text), "--domain",
                              std::to_string(own_dds_domain())});
  }
};

// On a kernel without CAN, and on one that has it but no interface of this name.
TEST_F(FailureLine, DemoWithoutACanInterface) {
  const std::string line =
      line_of("dyncal", {"demo", "--preset", "can", "--can", "nocan0", "--output", folder / "demo",
                         "--domain", std::to_string(own_dds_domain())});
  EXPECT_THAT(line, testing::AnyOf(HasSubstr("this kernel has no CAN sockets"),
                                   HasSubstr("there is no interface 'nocan0'; 'ip link add")));
}

TEST_F(FailureLine, CanSourceWithoutItsInterface) {
  write(folder / "sensor.dbc",
        "BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (0.01,0) [0|0] \"m/s^2\" S\n");
  const std::string text = replaced(
      bench_text, "[method]",
      "[sources.can]\ndriver = \"can\"\ninterface = \"nocan0\"\ndbc = \"sensor.dbc\"\n[method]");
  const std::string line = line_of("dyncal-can", {write(folder / "bench.toml", text), "--domain",
                                                  std::to_string(own_dds_domain())});
  EXPECT_THAT(line, HasSubstr("bench.toml:13: source 'can': "));
  EXPECT_THAT(line, testing::AnyOf(HasSubstr("this kernel has no CAN sockets"),
                                   HasSubstr("there is no interface 'nocan0'")));
}

TEST_F(FailureLine, DbcFileThatIsWrong) {
  write(folder / "sensor.dbc", "BO_ 291 Sample: 8 S\n SG_ x : 0|16@1- (0.01,0 [0|0] \"m/s^2\" S\n");
  const std::string text = replaced(
      bench_text, "[method]",
      "[sources.can]\ndriver = \"can\"\ninterface = \"nocan0\"\ndbc = \"sensor.dbc\"\n[method]");
  EXPECT_THAT(line_of("dyncal-can", {write(folder / "bench.toml", text), "--domain",
                                     std::to_string(own_dds_domain())}),
              HasSubstr("sensor.dbc:2: "));
}

TEST_F(FailureLine, BenchFileThatDoesNotExist) {
  EXPECT_THAT(line_of("dyncal", {"run", "nowhere.toml"}), HasSubstr("nowhere.toml: cannot read"));
}

TEST_F(FailureLine, WrongKey) {
  EXPECT_THAT(run_line(replaced(bench_text, "level =", "levl =")),
              HasSubstr("bench.toml:4: key 'excitation.levl' is not known; did you mean 'level'?"));
}

TEST_F(FailureLine, WrongUnit) {
  EXPECT_THAT(run_line(replaced(bench_text, "path = \"acs.csv\"",
                                "path = \"acs.csv\"\nunits = { sync = \"volts\" }")),
              HasSubstr("the unit \"volts\""));
}

TEST_F(FailureLine, RoleWithoutSource) {
  EXPECT_THAT(run_line(replaced(bench_text, "acs/reference", "acx/reference")),
              HasSubstr("names source 'acx', which [sources] does not have"));
}

TEST_F(FailureLine, SourceFileThatDoesNotExist) {
  EXPECT_THAT(run_line(replaced(bench_text, "acs.csv", "gone.csv")),
              HasSubstr("gone.csv, which does not exist"));
}

TEST_F(FailureLine, AnalysisThatIsNotThere) {
  EXPECT_THAT(run_line(bench_text), HasSubstr("no analysis service answers for bench 'broken'"));
}

TEST_F(FailureLine, SourceThatIsNotThere) {
  Laboratory laboratory(folder);
  laboratory.start("dyncal-analysis", {}, "fastdds");
  EXPECT_THAT(run_line(bench_text), HasSubstr("is not on the network; is its service running"));
}

TEST_F(FailureLine, SourceThatStaysSilent) {
  Laboratory laboratory(folder);
  const auto bench = write(folder / "bench.toml", bench_text);
  laboratory.start("dyncal-analysis", {}, "fastdds");
  laboratory.start("dyncal-acs", {bench}, "fastdds");
  laboratory.start("dyncal-dau", {bench}, "fastdds");
  EXPECT_THAT(run_line(bench_text), HasSubstr("source 'dau' of bench 'broken' is silent"));
}

TEST_F(FailureLine, ChannelThatDoesNotExist) {
  const std::string files = replaced(
      bench_text, "driver = \"smartup\"\nlisten = \"127.0.0.1:0\"\nsensor = \"0xbccb0100\"",
      "driver = \"file\"\npath = \"dau.csv\"");
  write(folder / "dau.csv", "t_ns,acceleration_z,sync\n0,1,2\n1000000,1,2\n2000000,1,2\n");
  const std::string text = replaced(files, "acs/reference", "acs/referense");
  const auto bench = write(folder / "bench.toml", text);
  Laboratory laboratory(folder);
  laboratory.start("dyncal-analysis", {}, "fastdds");
  laboratory.start("dyncal-acs", {bench}, "fastdds");
  EXPECT_THAT(run_line(text),
              HasSubstr("names channel 'referense', which source 'acs' does not have; did you mean "
                        "'reference'?"));
}

TEST_F(FailureLine, PortInUse) {
  const std::string port = std::to_string(own_udp_port());
  const auto bench =
      write(folder / "bench.toml", replaced(bench_text, "127.0.0.1:0", "127.0.0.1:" + port));
  Laboratory laboratory(folder);
  ProgramRun& first = laboratory.start("dyncal-dau", {bench}, "fastdds");
  ASSERT_TRUE(first.wait_for_error_text(port, patience)) << first.errors();
  EXPECT_THAT(line_of("dyncal-dau", {bench, "--domain", std::to_string(own_dds_domain())}),
              HasSubstr(port));
}

TEST_F(FailureLine, SensorIdThatIsNone) {
  const auto bench = write(folder / "bench.toml", replaced(bench_text, "0xbccb0100", "sensor-1"));
  EXPECT_THAT(line_of("dyncal-dau", {bench}), HasSubstr("must be a sensor id"));
}

} // namespace
} // namespace dyncal::tests
