// An exciter that is driven while nobody attends: the conductor hangs, so that neither it nor what
// watches over its process can switch the output off; the guard on the bench's side does.
#include <csignal>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

LiveBenchSettings long_steps(const std::string& dds) {
  LiveBenchSettings settings;
  settings.bench_arguments = {"--frequencies", "40,80", "--levels", "20"};
  settings.excitation = "frequencies_hz = [\"40\", \"80\"]\nlevel = 20.0\n"
                        "settling_s = 0.5\nduration_s = 300.0\n";
  settings.rest = "adc_delay_s = 1e-6\n";
  settings.dds = dds;
  return settings;
}

bool appears(const fs::path& file) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!fs::exists(file) && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
  }
  return fs::exists(file);
}

class UnattendedExciter : public testing::TestWithParam<std::string> {};

TEST_P(UnattendedExciter, IsSwitchedOffByTheGuardOfTheBench) {
  LiveBench bench(fresh_folder("unattended_exciter_" + GetParam()), long_steps(GetParam()));
  ProgramRun& guard = bench.start_service("dyncal-guard");
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  ASSERT_TRUE(run.wait_for_error_text("step 1 of 2", patience)) << run.errors();
  ASSERT_TRUE(bench.wait_for_output("ON"));
  ASSERT_TRUE(guard.wait_for_error_text("watching over run", patience));
  EXPECT_EQ(guard.errors().find("switched off"), std::string::npos) << guard.errors();
  run.send(SIGSTOP);
  EXPECT_TRUE(bench.wait_for_output("OFF")) << guard.errors();
  EXPECT_TRUE(guard.wait_for_error_text("the output of the generator was switched off", patience));
  EXPECT_THAT(guard.errors(), HasSubstr("bench live: nothing was heard of run "));
  run.send(SIGCONT);
  run.send(SIGINT);
  EXPECT_TRUE(run.wait(patience)) << run.errors();
}

TEST_P(UnattendedExciter, IsToldOfWhereThereIsNoGuard) {
  LiveBench bench(fresh_folder("unguarded_exciter_" + GetParam()), long_steps(GetParam()));
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  ASSERT_TRUE(run.wait_for_error_text("no dyncal-guard watches over the exciter of bench 'live'",
                                      patience));
  ProgramRun& guard = bench.start_service("dyncal-guard");
  ASSERT_TRUE(run.wait_for_error_text("a dyncal-guard watches over the exciter of bench 'live' now",
                                      patience));
  guard.send(SIGSTOP);
  EXPECT_TRUE(run.wait_for_error_text("has gone silent: should this program", patience));
  guard.send(SIGCONT);
  run.send(SIGINT);
  EXPECT_TRUE(run.wait(patience)) << run.errors();
}

// One power cut of both hosts; the generator has another supply.
TEST_P(UnattendedExciter, IsSwitchedOffByAGuardThatStartsAfterItsConductorDied) {
  LiveBench bench(fresh_folder("orphaned_exciter_" + GetParam()), long_steps(GetParam()));
  ProgramRun& guard = bench.start_service("dyncal-guard");
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  ASSERT_TRUE(run.wait_for_error_text("step 1 of 2", patience)) << run.errors();
  ASSERT_TRUE(bench.wait_for_output("ON"));
  ASSERT_TRUE(guard.wait_for_error_text("watching over run", patience));
  ASSERT_TRUE(appears(fs::path(bench.bench_file()).parent_path() / "state/dyncal-guard/live.json"));
  run.send(SIGSTOP); // its own guard of the output sleeps on
  guard.send(SIGKILL);
  ASSERT_TRUE(guard.wait(patience));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "ON");
  ProgramRun& again = bench.start_service("dyncal-guard");
  EXPECT_TRUE(bench.wait_for_output("OFF")) << again.errors();
  EXPECT_TRUE(
      again.wait_for_error_text("drove the generator when this guard was last there", patience));
  EXPECT_TRUE(again.wait_for_error_text("the output of the generator was switched off", patience));
  run.send(SIGCONT);
  run.send(SIGINT);
  EXPECT_TRUE(run.wait(patience)) << run.errors();
}

TEST_P(UnattendedExciter, IsLeftToAPersonAfterTheRun) {
  LiveBench bench(fresh_folder("persons_exciter_" + GetParam()), long_steps(GetParam()));
  ProgramRun& guard = bench.start_service("dyncal-guard");
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  ASSERT_TRUE(run.wait_for_error_text("step 1 of 2", patience)) << run.errors();
  ASSERT_TRUE(bench.wait_for_output("ON"));
  run.send(SIGINT);
  EXPECT_TRUE(run.wait(patience)) << run.errors();
  ASSERT_TRUE(bench.wait_for_output("OFF"));
  bench.tell_generator(":SOURce1:FREQuency 80");
  bench.tell_generator(":OUTPut1 ON");
  EXPECT_TRUE(guard.wait_for_error_text("the output of the generator is on (80 Hz", patience));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "ON");
  bench.tell_generator(":SOURce1:FREQuency 40"); // exactly what the run drove
  EXPECT_TRUE(bench.wait_for_output("OFF")) << guard.errors();
}

// With steps of a second and a half.
LiveBenchSettings faulty(const std::vector<std::string>& faults) {
  LiveBenchSettings settings = long_steps("cyclonedds");
  settings.excitation = "frequencies_hz = [\"40\", \"80\"]\nlevel = 20.0\n"
                        "settling_s = 0.5\nduration_s = 1.5\nattempts = 1\n";
  for (const std::string& fault : faults) {
    settings.bench_arguments.insert(settings.bench_arguments.end(), {"--fault", fault});
  }
  return settings;
}

// Its generator answers that the output is off.
TEST(ExciterThatGoesOn, IsSeenByTheReferenceAndSaid) {
  LiveBench bench(fresh_folder("exciter_that_goes_on"), faulty({"output-stays-on"}));
  ProgramRun& guard = bench.start_service("dyncal-guard");
  ProgramRun& run = bench.start({"run", bench.bench_file()});
  ASSERT_TRUE(guard.wait_for_error_text("watching over run", patience));
  EXPECT_TRUE(guard.wait_for_error_text("but acs/reference still shows the", patience));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");
  EXPECT_THAT(guard.errors(), HasSubstr("THE OUTPUT OF THE GENERATOR MAY BE ON"));
  EXPECT_TRUE(run.wait(patience));
  EXPECT_THAT(run.errors(), HasSubstr("MAY BE ON: nobody has confirmed that it is off"));
  ProgramRun& next = bench.start({"run", bench.bench_file()}); // before which it was seen
  EXPECT_TRUE(next.wait_for_error_text("but acs/reference still shows the", patience));
  EXPECT_TRUE(next.wait(patience));
}

TEST(ExciterThatGoesOn, IsNotTakenForOneThatRingsNorForHum) {
  for (const char* fault : {"ring-down=1.0", "hum=0.3,at=reference,frequency=80"}) {
    LiveBench bench(fresh_folder("exciter_that_rings_or_hums"), faulty({fault}));
    ProgramRun& guard = bench.start_service("dyncal-guard");
    ProgramRun& run = bench.start({"run", bench.bench_file()});
    EXPECT_TRUE(run.wait(patience));
    EXPECT_THAT(guard.errors(), HasSubstr("watching over run"));
    EXPECT_FALSE(guard.wait_for_error_text("MAY BE ON", std::chrono::seconds(5))) << fault;
    EXPECT_THAT(run.errors(), testing::Not(HasSubstr("MAY BE ON"))) << fault;
  }
}

INSTANTIATE_TEST_SUITE_P(EachVendor, UnattendedExciter, testing::Values("fastdds", "cyclonedds"),
                         [](const auto& vendor) { return vendor.param; });

} // namespace
} // namespace dyncal::tests
