// A bench that demands a check: another sensor is refused before anything is excited, unless a
// reason is stated, which result and report then say; the check sensor itself is measured.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

nlohmann::json check_of_only_run(const fs::path& runs) {
  nlohmann::json check;
  for (const auto& entry : fs::directory_iterator(runs / "live")) {
    EXPECT_TRUE(check.is_null()) << "more than one run";
    check = read_json(entry.path() / "result.json").at("check");
  }
  return check;
}

TEST(RequiredCheck, StopsARunUnlessAReasonIsStated) {
  const auto folder = fresh_folder("required-check");
  LiveBenchSettings settings;
  settings.bench_arguments = {"--speed", "8"};
  settings.excitation = "frequencies_hz = [\"80\"]\nlevel = 10.0\nsettling_s = 0.5\n"
                        "duration_s = 1.0\n";
  settings.rest = "[check]\nsensor  = \"0xbccb0100\"\nmax_age_h = 24.0\nfirst = 3\n";
  LiveBench bench(folder, settings);
  const fs::path of_customer =
      bench.changed_bench_file("customer.toml", "sensor  =", "sensor = \"check-1\"");

  ProgramRun& refused = bench.start({"run", of_customer, "--folder", folder / "refused"});
  EXPECT_NE(refused.wait(patience), 0);
  EXPECT_THAT(refused.errors(),
              AllOf(HasSubstr("demands a check with sensor 'check-1'"),
                    HasSubstr("Mount the check sensor"), HasSubstr("--without-check REASON")));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");
  std::error_code none;
  EXPECT_EQ(fs::directory_iterator(folder / "refused" / "live", none), fs::directory_iterator());

  ProgramRun& stated = bench.start({"run", of_customer, "--folder", folder / "stated",
                                    "--without-check", "the check sensor is away"});
  ASSERT_EQ(stated.wait(patience), 0) << stated.errors();
  EXPECT_THAT(stated.output(), HasSubstr("was left out: the check sensor is away"));
  EXPECT_EQ(check_of_only_run(folder / "stated").at("left_out"), "the check sensor is away");
  const fs::path run = fs::directory_iterator(folder / "stated" / "live")->path();
  ProgramRun report("dyncal", {"report", run, "--no-pdf"}, folder);
  ASSERT_EQ(report.wait(patience), 0) << report.errors();
  std::ifstream html(run / "report.html");
  EXPECT_THAT(std::string(std::istreambuf_iterator<char>(html), {}),
              HasSubstr("was left out: the check sensor is away"));

  // Evaluated anew, it is a run of that bench still.
  ProgramRun again("dyncal", {"analyse", run, "--output", folder / "again.json"}, folder);
  ASSERT_EQ(again.wait(patience), 0) << again.errors();
  std::ifstream evaluated(folder / "again.json");
  EXPECT_EQ(nlohmann::json::parse(evaluated).at("check").at("left_out"),
            "the check sensor is away");

  ProgramRun& check = bench.start({"run", bench.bench_file(), "--folder", folder / "check"});
  ASSERT_EQ(check.wait(patience), 0) << check.errors();
  const auto of_check = check_of_only_run(folder / "check");
  EXPECT_EQ(of_check.at("sensor"), "0xbccb0100");
  EXPECT_EQ(of_check.at("left_out"), "");
}

} // namespace
} // namespace dyncal::tests
