#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/checks/doctor/checks.hpp"
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
    wire::SourceDescription description;
    description.host("lab-2");
    description.process_id(7);
    description.settings("sensor = \"1\"\n");
    description.bench_file_sha256("aa");
    wire::SourceStatus status;
    status.state(wire::SOURCE_RUNNING);
    status.rate_hz(1000.0);
    dau() = {.description = description,
             .first_status = status,
             .status = status,
             .writers = {"lab-2:7"},
             .twins = false};
  }
  ObservedSource& dau() { return view_.sources[{"acc-1", "dau"}]; }
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
  dau().status->rate_hz(1011.0);
  EXPECT_THAT(warnings(check(bench)), IsEmpty());
  dau().status->rate_hz(2000.0);
  EXPECT_THAT(warnings(check(bench)),
              ElementsAre(HasSubstr("source acc-1/dau sends 2000 samples a second, but its "
                                    "nominal_rate_hz is 1000")));
}

TEST_F(CheckSources, SaysThatThereIsNone) {
  view_.sources.clear();
  EXPECT_THAT(warnings(check()), ElementsAre("sources: no source is there"));
}

TEST_F(CheckSources, NamesASilentSourceWithItsOwnReason) {
  dau().status->state(wire::SOURCE_SILENT);
  dau().status->message("sensor 0x1 does not send");
  EXPECT_THAT(problems(check()), ElementsAre(AllOf(HasSubstr("acc-1/dau on lab-2 is silent"),
                                                   HasSubstr("sensor 0x1 does not send"))));
}

TEST_F(CheckSources, NamesASourceWithoutStatus) {
  dau().status.reset();
  EXPECT_THAT(problems(check()), ElementsAre(HasSubstr("no status comes")));
}

TEST_F(CheckSources, TellsLossNowFromLossBefore) {
  dau().first_status->lost_in_transit(3);
  dau().status->lost_in_transit(3);
  EXPECT_THAT(warnings(check()), ElementsAre(HasSubstr("3 samples were lost between device and "
                                                       "service since its service was started")));
  dau().status->lost_in_transit(5);
  EXPECT_THAT(problems(check()), ElementsAre(HasSubstr("2 samples were lost between device and "
                                                       "service while I looked")));
  dau().status->lost_in_transit(0);
  dau().status->dropped_in_service(9);
  EXPECT_THAT(problems(check()), ElementsAre(HasSubstr("9 samples were dropped")));
}

TEST_F(CheckSources, NamesABufferThatFills) {
  dau().status->buffer_fill(0.8);
  EXPECT_THAT(warnings(check()), ElementsAre(HasSubstr("its buffer is 80 % full")));
}

TEST_F(CheckSources, NamesTwinsAndWhereTheyAre) {
  dau().twins = true;
  dau().writers = {"lab-2:7", "lab-3:8"};
  EXPECT_THAT(problems(check()),
              ElementsAre("twins: two services publish source acc-1/dau: lab-2:7 and lab-3:8; end "
                          "one of them, or give it another name"));
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
  view_.sources[{"acc-2", "acs"}].description->bench_file_sha256("cc");
  EXPECT_THAT(warnings(check()), IsEmpty());
  view_.sources[{"acc-1", "acs"}].description->bench_file_sha256("bb");
  EXPECT_THAT(warnings(check()),
              ElementsAre(HasSubstr("services of bench acc-1 have read different bench files")));
}

} // namespace
} // namespace dyncal::inline checks::doctor
