#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/laboratory_view.hpp"
#include "tests/unit/services/checks/doctor/findings.hpp"

namespace dyncal::inline checks::doctor {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::problems;
using tests::warnings;

class CheckSources : public testing::Test {
protected:
  CheckSources() {
    dau().host = "lab-2";
    dau().bench_file = {"aa", "sensor = \"1\"\n"};
    dau().services = {"lab-2:7"};
    dau().state = network::SourceState::running;
    dau().rate_hz = 1000.0;
  }
  network::Source& dau() { return view_.sources[{"acc-1", "dau"}]; }
  [[nodiscard]] Findings check(const std::optional<BenchFile>& bench = std::nullopt) const {
    return check_sources(view_, bench);
  }
  static BenchFile bench_file(const std::string& settings) {
    BenchFile bench;
    bench.path = "bench.toml";
    bench.bench = "acc-1";
    bench.sha256 = "aa";
    SourceSettings& source = bench.sources.emplace_back();
    source.name = "dau";
    source.origin.settings = settings;
    return bench;
  }

  LaboratoryView view_;
};

TEST_F(CheckSources, IsContentWithASourceThatRuns) {
  EXPECT_THAT(problems(check()), IsEmpty());
  EXPECT_THAT(warnings(check()), IsEmpty());
  EXPECT_THAT(check().at(0).sentence, HasSubstr("acc-1/dau on lab-2 is running, 1000.0 samples"));
}

TEST_F(CheckSources, HoldsTheRateAgainstThatOfTheBenchFile) {
  BenchFile bench = bench_file("sensor = \"1\"\n");
  bench.sources.front().nominal_rate_hz = 1000.0;
  dau().rate_hz = 1011.0;
  EXPECT_THAT(warnings(check(bench)), IsEmpty());
  dau().rate_hz = 2000.0;
  EXPECT_THAT(warnings(check(bench)),
              ElementsAre(HasSubstr("source acc-1/dau sends 2000 samples a second, but its "
                                    "nominal_rate_hz is 1000")));
}

TEST_F(CheckSources, SaysThatThereIsNone) {
  view_.sources.clear();
  EXPECT_THAT(warnings(check()), ElementsAre("sources: no source is there"));
}

TEST_F(CheckSources, NamesASilentSourceWithItsOwnReason) {
  dau().state = network::SourceState::silent;
  dau().message = "sensor 0x1 does not send";
  EXPECT_THAT(problems(check()), ElementsAre(AllOf(HasSubstr("acc-1/dau on lab-2 is silent"),
                                                   HasSubstr("sensor 0x1 does not send"))));
}

TEST_F(CheckSources, NamesASourceWithoutStatus) {
  dau().state = network::SourceState::unknown;
  EXPECT_THAT(problems(check()), ElementsAre(HasSubstr("no status comes")));
}

TEST_F(CheckSources, TellsLossNowFromLossBefore) {
  dau().first_counts.lost_on_way = 3;
  dau().counts.lost_on_way = 3;
  EXPECT_THAT(warnings(check()), ElementsAre(HasSubstr("3 samples were lost between device and "
                                                       "service since its service was started")));
  dau().counts.lost_on_way = 5;
  EXPECT_THAT(problems(check()), ElementsAre(HasSubstr("2 samples were lost between device and "
                                                       "service while I looked")));
  dau().counts.lost_on_way = 0;
  dau().dropped_in_service = 9;
  EXPECT_THAT(problems(check()), ElementsAre(HasSubstr("9 samples were dropped")));
}

TEST_F(CheckSources, NamesABufferThatFills) {
  dau().buffer_fill = 0.8;
  EXPECT_THAT(warnings(check()), ElementsAre(HasSubstr("its buffer is 80 % full")));
}

TEST_F(CheckSources, NamesTwinsAndWhereTheyAre) {
  for (const std::uint64_t session : {1U, 2U, 1U, 2U}) {
    dau().turns.add(session);
  }
  dau().services = {"lab-2:7", "lab-3:8"};
  EXPECT_THAT(problems(check()),
              ElementsAre("twins: two services publish source acc-1/dau: lab-2:7 and lab-3:8; end "
                          "one of them, or give it another name"));
}

TEST_F(CheckSources, NamesTheHostsOfTwinsOfWhichOneDescriptionCame) {
  for (const std::uint64_t session : {1, 2, 1, 2, 1}) {
    dau().turns.add(session);
  }
  view_.senders[{"acc-1", "dau"}] = {"0110", "010f"};
  view_.discovery.participants = {{"0110", "dyncal-dau", "Cyclone DDS"},
                                  {"010f", "dyncal-dau", "Fast DDS"}};
  view_.addresses = {{"0110", "10.98.0.1"}, {"010f", "10.98.0.2"}};
  EXPECT_THAT(problems(check()), ElementsAre(HasSubstr("dyncal-dau (Fast DDS, 10.98.0.2) and "
                                                       "dyncal-dau (Cyclone DDS, 10.98.0.1)")));
}

TEST_F(CheckSources, LetsAFileWaitForItsRun) {
  dau().state = network::SourceState::starting;
  EXPECT_THAT(warnings(check()), ElementsAre(HasSubstr("has received nothing yet")));
  dau().description.emplace().driver = "file";
  EXPECT_THAT(warnings(check()), IsEmpty());
}

TEST_F(CheckSources, ComparesWithTheBenchFile) {
  EXPECT_THAT(problems(check(bench_file("sensor = \"1\"\n"))), IsEmpty());
  EXPECT_THAT(problems(check(bench_file("sensor = \"2\"\n"))),
              ElementsAre(HasSubstr("key 'sources.dau.sensor' is \"1\" there and \"2\" here")));
  BenchFile other = bench_file("sensor = \"1\"\n");
  other.sha256 = "bb";
  EXPECT_THAT(problems(check(other)), IsEmpty());
  EXPECT_THAT(warnings(check(other)), IsEmpty()) << "steps may differ";
  other.bench = "acc-9";
  EXPECT_THAT(problems(check(other)), ElementsAre(HasSubstr("acc-9/dau of bench.toml is not on "
                                                            "the network")));
}

TEST_F(CheckSources, NamesServicesOfABenchThatReadDifferentFiles) {
  view_.sources[{"acc-1", "acs"}] = dau();
  view_.sources[{"acc-2", "acs"}] = dau();
  view_.sources[{"acc-2", "acs"}].bench_file.sha256 = "cc";
  EXPECT_THAT(warnings(check()), IsEmpty());
  view_.sources[{"acc-1", "acs"}].bench_file.sha256 = "bb";
  EXPECT_THAT(warnings(check()),
              ElementsAre(HasSubstr("services of bench acc-1 have read different bench files")));
}

} // namespace
} // namespace dyncal::inline checks::doctor
