// Runs of a secured laboratory give the bits of plain ones, whichever DDS implementation carries
// them; who does not belong to it is refused by its own program.
#include <iostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/base/version.hpp"
#include "tests/security/secured_laboratory.hpp"
#include "tests/system/laboratory.hpp"
#include "tests/system/test_folder.hpp"

namespace dyncal::tests {
namespace {

namespace fs = std::filesystem;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

constexpr const char* bench_name = "files";

struct Vendors {
  std::string acs;
  std::string analysis;
};

// The folders of the three programs; empty: plain.
struct Folders {
  std::string source;
  std::string analysis;
  std::string conductor;
};

Folders folders_of(const SecuredLaboratory& lab) {
  return {lab.folder_of("source"), lab.folder_of("analysis"), lab.folder_of("operator")};
}

nlohmann::json result_over(const fs::path& folder, const fs::path& bench, const Vendors& vendors,
                           const Folders& secured) {
  Laboratory laboratory(folder);
  laboratory.start("dyncal-analysis", with_security({}, secured.analysis), vendors.analysis);
  laboratory.start("dyncal-acs", with_security({bench}, secured.source), vendors.acs);
  const fs::path json =
      folder / (vendors.acs + vendors.analysis + (secured.source.empty() ? "" : "-secured"));
  ProgramRun& command = laboratory.start(
      "dyncal", with_security({"run", bench, "--output", json}, secured.conductor), vendors.acs);
  EXPECT_EQ(command.wait(patience), 0) << json << command.output() << command.errors();
  return read_json(json);
}

TEST(SecuredRuns, AreThoseOfAPlainLaboratoryToTheBit) {
  const auto folder = fresh_folder("secured-runs");
  const auto bench = recorded_bench(folder, bench_name, "3");
  const Folders secured = folders_of(SecuredLaboratory(folder, bench_name));
  const auto plain = result_over(folder, bench, {"cyclonedds", "cyclonedds"}, {});
  ASSERT_FALSE(plain.is_discarded());
  ASSERT_EQ(plain["points"].size(), 18U);
  const auto expect_the_same = [&](const Vendors& vendors, const Folders& folders) {
    const auto result = result_over(folder, bench, vendors, folders);
    ASSERT_FALSE(result.is_discarded()) << vendors.acs << vendors.analysis;
    EXPECT_EQ(result["points"], plain["points"]);
    EXPECT_EQ(result["transfer_function"], plain["transfer_function"]);
  };
  expect_the_same({"cyclonedds", "cyclonedds"}, secured);
  if (base::build_description().find("fastdds 3.") != std::string::npos) {
    std::cout << "not mixed: Fast DDS 3 talks to no other secured DDS\n";
    expect_the_same({"fastdds", "fastdds"},
                    folders_of(SecuredLaboratory(folder / "alone", bench_name, "fastdds")));
    return;
  }
  expect_the_same({"fastdds", "fastdds"}, secured);
  expect_the_same({"cyclonedds", "fastdds"}, secured);
  expect_the_same({"fastdds", "cyclonedds"}, secured);
}

class WrongIdentity : public testing::TestWithParam<std::string> {
protected:
  // The sentence that a program ends with.
  std::string refusal_of(const std::string& program, const std::vector<std::string>& arguments,
                         const std::string& name) {
    Laboratory laboratory(folder_);
    std::vector<std::string> all = with_security(arguments, lab_.folder_of(name));
    all.insert(all.end(), {"--domain", std::to_string(own_dds_domain()), "--dds", GetParam()});
    ProgramRun run(program, all, folder_);
    EXPECT_NE(run.wait(patience).value_or(0), 0) << run.errors();
    return run.errors();
  }

  fs::path folder_ = fresh_folder_of_this_test();
  fs::path bench_ = recorded_bench(folder_, bench_name, "3");
  SecuredLaboratory lab_{folder_, bench_name, GetParam()};
};

TEST_P(WrongIdentity, IsRefusedByTheProgramThatHasIt) {
  EXPECT_THAT(refusal_of("dyncal-acs", {bench_}, "nowhere"), HasSubstr("cannot be read"));
  EXPECT_THAT(refusal_of("dyncal-acs", {bench_}, "analysis"),
              HasSubstr("is not of the role 'source', which dyncal-acs needs"));
  EXPECT_THAT(refusal_of("dyncal", {"run", bench_}, "source"),
              HasSubstr("is not of the role 'operator', which dyncal-run needs"));
  lab_.issue("source", {"--bench", "other"}, "other-bench");
  EXPECT_THAT(refusal_of("dyncal-acs", {bench_}, "other-bench"),
              HasSubstr("of bench 'files'? It is made for a role and its benches"));
  lab_.issue("operator", {"--bench", bench_name, "--days", "0.0001"}, "short");
  EXPECT_THAT(refusal_of("dyncal", {"run", bench_}, "short"),
              HasSubstr("before the end of the run"));
  lab_.call({"revoke", lab_.authority(), "source-files"});
  fs::copy_file(fs::path(lab_.authority()) / "revoked.pem",
                fs::path(lab_.folder_of("source")) / "revoked.pem",
                fs::copy_options::overwrite_existing);
  EXPECT_THAT(refusal_of("dyncal-acs", {bench_}, "source"), HasSubstr("has been revoked"));
}

TEST_P(WrongIdentity, SeesNothingAndIsNotSeenWithoutAny) {
  Laboratory laboratory(folder_);
  ProgramRun& analysis = laboratory.start(
      "dyncal-analysis", with_security({}, lab_.folder_of("analysis")), GetParam());
  laboratory.start("dyncal-acs", with_security({bench_}, lab_.folder_of("source")), GetParam());
  lab_.issue("watcher", {});
  const auto list = [&](const std::string& folder) {
    ProgramRun& run = laboratory.start("dyncal", with_security({"list"}, folder), GetParam());
    EXPECT_TRUE(run.wait(patience)) << run.errors();
    return run.output() + run.errors();
  };
  EXPECT_THAT(list(lab_.folder_of("watcher")), HasSubstr(bench_name));
  EXPECT_THAT(list(lab_.folder_of("watcher")), Not(HasSubstr("may not talk to")));
  EXPECT_THAT(list(""), Not(HasSubstr(bench_name)));
  laboratory.start("dyncal-analysis", {}, GetParam());
  ProgramRun& doctor = laboratory.start(
      "dyncal", with_security({"doctor", "--seconds", "3"}, lab_.folder_of("watcher")), GetParam());
  EXPECT_TRUE(doctor.wait(patience)) << doctor.errors();
  const std::string stranger = "1 program is here that this program may not talk to: "
                               "dyncal-analysis:[0-9]+ on [^ ]+ .without --security";
  EXPECT_THAT(doctor.output(), ContainsRegex(stranger));
  EXPECT_THAT(list(lab_.folder_of("watcher")), ContainsRegex(stranger));
  EXPECT_TRUE(analysis.wait_for_error_text("that this program may not talk to", patience));
  EXPECT_THAT(analysis.errors(), ContainsRegex(stranger));
}

TEST_P(WrongIdentity, OfAnotherAuthorityIsNamedByThoseWhoMayNotTalkToIt) {
  const SecuredLaboratory other(folder_ / "other", bench_name, GetParam());
  lab_.issue("watcher", {});
  Laboratory laboratory(folder_);
  laboratory.start("dyncal-analysis", with_security({}, other.folder_of("analysis")), GetParam());
  ProgramRun& doctor = laboratory.start(
      "dyncal", with_security({"doctor", "--seconds", "5"}, lab_.folder_of("watcher")), GetParam());
  EXPECT_TRUE(doctor.wait(patience)) << doctor.errors();
  EXPECT_THAT(doctor.output(), HasSubstr("1 program is here that this program may not talk to"));
  EXPECT_THAT(doctor.output(), ContainsRegex("of (the|another) authority")) << "as announced";
}

INSTANTIATE_TEST_SUITE_P(EitherVendor, WrongIdentity, testing::Values("cyclonedds", "fastdds"),
                         [](const auto& one) { return one.param; });

} // namespace
} // namespace dyncal::tests
