// A run that a visitor of the page starts in a secured laboratory: by the certificate of an
// operator that dyncal-web is given for it, since that of the page itself conducts nothing.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/security/secured_laboratory.hpp"
#include "tests/system/laboratory.hpp"
#include "tests/system/test_folder.hpp"
#include "tests/system/web_visitor.hpp"

namespace dyncal::tests {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

constexpr const char* token = "a secret of the laboratory";

class SecuredPage : public testing::Test {
protected:
  SecuredPage() {
    lab_.issue("web", {});
    std::ofstream(folder_ / "token") << token << '\n';
    fs::permissions(folder_ / "token", fs::perms::owner_read);
  }
  // `run_folder`: of --run-security; empty: without.
  std::vector<std::string> web_arguments(const std::string& run_folder) {
    std::vector<std::string> arguments =
        with_security({"--listen", "127.0.0.1:0", "--token-file", folder_ / "token", "--benches",
                       folder_, "--runs", folder_ / "runs"},
                      lab_.folder_of("web"));
    if (!run_folder.empty()) {
      arguments.insert(arguments.end(), {"--run-security", run_folder});
    }
    return arguments;
  }
  static json start_run(ProgramRun& web) {
    return WebVisitor(web, token).post("/api/run", {{"file", "bench.toml"}});
  }

  fs::path folder_ = fresh_folder_of_this_test();
  fs::path bench_ = recorded_bench(folder_, "files", "3");
  SecuredLaboratory lab_{folder_, "files", "cyclonedds"};
  Laboratory laboratory_{folder_};
};

TEST_F(SecuredPage, StartsRunsByTheCertificateOfAnOperator) {
  laboratory_.start("dyncal-analysis", with_security({}, lab_.folder_of("analysis")), "cyclonedds");
  laboratory_.start("dyncal-acs", with_security({bench_}, lab_.folder_of("source")), "cyclonedds");
  ProgramRun& web =
      laboratory_.start("dyncal-web", web_arguments(lab_.folder_of("operator")), "cyclonedds");
  const json started = start_run(web);
  ASSERT_EQ(started["status"], 200) << started;
  const json done = WebVisitor(web, token).ask_until("/api/bench/files", [](const json& bench) {
    return bench["state"] == "done";
  });
  ASSERT_EQ(done["state"], "done") << done << started["message"];
  EXPECT_EQ(done["results"], 18);
}

TEST_F(SecuredPage, StartsNoRunWithoutOne) {
  ProgramRun& web = laboratory_.start("dyncal-web", web_arguments(""), "cyclonedds");
  const json refused = start_run(web);
  EXPECT_EQ(refused["status"], 409) << refused;
  EXPECT_THAT(refused["message"].dump(), HasSubstr("no certificate to conduct runs with"));
}

TEST_F(SecuredPage, RefusesAFolderThatConductsNothing) {
  std::vector<std::string> arguments = web_arguments(lab_.folder_of("web"));
  arguments.insert(arguments.end(), {"--domain", std::to_string(own_dds_domain())});
  ProgramRun web("dyncal-web", arguments, folder_);
  EXPECT_EQ(web.wait(patience), 1) << web.errors();
  EXPECT_THAT(web.errors(), HasSubstr("is not of the role 'operator', which dyncal-run needs"));
}

} // namespace
} // namespace dyncal::tests
