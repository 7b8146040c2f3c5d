#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/laboratory_view.hpp"
#include "tests/unit/services/checks/doctor/findings.hpp"

namespace dyncal::inline checks::doctor {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::problems;
using tests::sentences;
using tests::warnings;

class CheckGuards : public testing::Test {
protected:
  CheckGuards() {
    bench_.bench = "acc-1";
    bench_.generator.driver = GeneratorDriver::scpi;
    bench_.generator.address = "192.0.2.7:5025";
  }
  network::Service& add_guard(const std::string& bench, const std::string& generator) {
    network::Service& guard = view_.guards[{bench, "guard@lab-2:7"}];
    guard.host = "lab-2";
    guard.guarded_generator = generator;
    return guard;
  }

  LaboratoryView view_;
  BenchFile bench_;
};

TEST_F(CheckGuards, NamesThoseThatAreThere) {
  add_guard("acc-1", "192.0.2.7:5025");
  const Findings findings = check_guards(view_, bench_);
  EXPECT_THAT(sentences(findings, Severity::ok),
              ElementsAre("guards: bench acc-1: dyncal-guard on lab-2 guards the output of the "
                          "generator 192.0.2.7:5025"));
  EXPECT_EQ(findings.size(), 1U);
}

TEST_F(CheckGuards, MissesTheOneOfABench) {
  add_guard("acc-2", "192.0.2.7:5025");
  EXPECT_THAT(warnings(check_guards(view_, bench_)),
              ElementsAre(HasSubstr("bench acc-1: no dyncal-guard is there")));
}

TEST_F(CheckGuards, NamesOneOfAnotherAddress) {
  add_guard("acc-1", "192.0.2.8:5025");
  EXPECT_THAT(warnings(check_guards(view_, bench_)),
              ElementsAre(HasSubstr("this bench file has the generator at 192.0.2.7:5025, and "
                                    "dyncal-guard switches off the one at 192.0.2.8:5025")));
}

TEST_F(CheckGuards, TakesAnAddressOfTheLoopbackInterfaceForTheSame) {
  add_guard("acc-1", "127.0.0.1:5025");
  EXPECT_THAT(warnings(check_guards(view_, bench_)), IsEmpty());
}

TEST_F(CheckGuards, IsAlarmedByAnOutputThatMayBeOn) {
  network::Service& guard = add_guard("acc-1", "192.0.2.7:5025");
  guard.health = network::Health::failed;
  guard.message = "THE OUTPUT MAY BE ON";
  EXPECT_THAT(problems(check_guards(view_, std::nullopt)),
              ElementsAre("guards: bench acc-1: dyncal-guard on lab-2: THE OUTPUT MAY BE ON"));
}

TEST_F(CheckGuards, AsksForNoneWhereNoneIsNeeded) {
  bench_.generator.driver = GeneratorDriver::by_hand;
  EXPECT_THAT(warnings(check_guards(view_, bench_)), IsEmpty());
  EXPECT_THAT(warnings(check_guards(view_, std::nullopt)), IsEmpty());
  EXPECT_EQ(check_guards(view_, std::nullopt).size(), 1U);
}

} // namespace
} // namespace dyncal::inline checks::doctor
