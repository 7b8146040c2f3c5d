// `dyncal doctor` with nothing on the network, with services, and with a bench file that differs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"
#include "tests/system/test_folder.hpp"

namespace dyncal::tests {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class DoctorTest : public testing::Test {
protected:
  struct Answer {
    int status = -1;
    nlohmann::json report;
    std::string text;
  };
  Answer ask(std::vector<std::string> arguments, bool json = true) {
    arguments.insert(arguments.begin(), "doctor");
    arguments.insert(arguments.end(),
                     {"--seconds", "4", "--domain", std::to_string(own_dds_domain())});
    if (json) {
      arguments.emplace_back("--json");
    }
    ProgramRun doctor("dyncal", arguments, folder_);
    const auto status = doctor.wait(patience);
    EXPECT_TRUE(status) << doctor.errors();
    return {status.value_or(-1), nlohmann::json::parse(doctor.output(), nullptr, false),
            doctor.output()};
  }
  // "check: sentence" of the findings of that severity.
  static std::vector<std::string> findings(const Answer& answer, const std::string& severity) {
    std::vector<std::string> texts;
    for (const auto& finding : answer.report["findings"]) {
      if (finding["severity"] == severity) {
        texts.push_back(finding["check"].get<std::string>() + ": " +
                        finding["sentence"].get<std::string>());
      }
    }
    return texts;
  }

  std::filesystem::path folder_ = fresh_folder_of_this_test();
};

TEST_F(DoctorTest, SaysThatNothingIsThere) {
  const Answer answer = ask({});
  EXPECT_EQ(answer.status, 5) << answer.text;
  EXPECT_THAT(findings(answer, "warning"), Contains(HasSubstr("nothing is on DDS domain")));
  EXPECT_TRUE(findings(answer, "problem").empty()) << answer.text;
  EXPECT_TRUE(answer.report["programs"].empty());
}

TEST_F(DoctorTest, MissesTheSourcesOfABenchFile) {
  recorded_bench(folder_, "doctored", "1");
  const Answer answer = ask({folder_ / "bench.toml"});
  EXPECT_EQ(answer.status, 3) << answer.text;
  EXPECT_THAT(findings(answer, "problem"), Contains(HasSubstr("source doctored/dau of")).Times(1));
}

TEST_F(DoctorTest, RefusesABenchFileThatIsNotThere) {
  EXPECT_EQ(ask({folder_ / "nothing.toml"}).status, 4) << "3 is for problems of what it saw";
}

class DoctorWithServices : public DoctorTest, public testing::WithParamInterface<std::string> {};

TEST_P(DoctorWithServices, SeesThemInWhicheverVendor) {
  const auto bench = recorded_bench(folder_, "doctored", "1");
  Laboratory laboratory(folder_);
  laboratory.start("dyncal-analysis", {}, "cyclonedds");
  laboratory.start("dyncal-acs", {bench}, "fastdds");
  const Answer answer = ask({bench, "--dds", GetParam()});
  EXPECT_THAT(answer.status, testing::AnyOf(0, 5)) << answer.text;
  std::vector<std::string> programs;
  for (const auto& program : answer.report["programs"]) {
    programs.push_back(program["program"].get<std::string>() + " " +
                       program["dds"].get<std::string>());
  }
  EXPECT_THAT(programs,
              testing::UnorderedElementsAre("dyncal-analysis cyclonedds", "dyncal-acs fastdds"));
  EXPECT_EQ(answer.report["sources"].size(), 2U);
  EXPECT_EQ(answer.report["participants"].size(), 2U);
  for (const auto& participant : answer.report["participants"]) {
    EXPECT_GT(participant["endpoints"], 2) << answer.text;
  }
  EXPECT_THAT(findings(answer, "ok"), Contains(HasSubstr("none that should match and does not")));
  EXPECT_THAT(findings(answer, "ok"), Contains(HasSubstr("their services have read this file")));
}

INSTANTIATE_TEST_SUITE_P(Vendors, DoctorWithServices, testing::Values("cyclonedds", "fastdds"));

TEST_F(DoctorTest, NamesWhatDiffersInTheBenchFile) {
  const auto bench = recorded_bench(folder_, "doctored", "1");
  Laboratory laboratory(folder_);
  laboratory.start("dyncal-acs", {bench}, "cyclonedds");
  std::ifstream in(bench);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::string line = "path = \"acs.csv\"\n";
  text.replace(text.find(line), line.size(), line + "serial = \"4711\"\n");
  std::ofstream(folder_ / "other.toml") << text;
  const Answer answer = ask({folder_ / "other.toml"}, false);
  EXPECT_EQ(answer.status, 3) << answer.text;
  EXPECT_THAT(answer.text,
              HasSubstr("key 'sources.acs.serial' is nothing there and \"4711\" here"));
  EXPECT_THAT(answer.text, Not(HasSubstr("sources.dau")));
}

} // namespace
} // namespace dyncal::tests
