// What a program that writes on a bench in the name of others, by a DDS library of its own, does to
// runs over either DDS implementation and both. Plain: no value is another one without a flag, or
// the run ends. Secured: it hears nothing, and nothing changes.
//
// DYNCAL_FORGERIES=6: as many draws of each attack over all implementations; otherwise one draw of
// each over one of them.
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <optional>
#include <random>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/faults/forger.hpp"
#include "tests/security/secured_laboratory.hpp"
#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* bench_name = "files";

struct Draw {
  unsigned number = 0; // of the seed
  std::mt19937 random{number};

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  }
  bool coin() { return random() % 2 == 0; }
};

struct Attack {
  const char* name;
  std::function<void(Forger& forger, Draw& draw)> begin;
  std::string named; // in what the run says where it does not end as if nothing were
};

const std::vector<Attack>& attacks() {
  static const std::vector<Attack> all{
      {"samples",
       [](Forger& forger, Draw& draw) {
         forger.send_as(draw.coin() ? "dau" : "acs", draw.between(0.5, 1.5));
       },
       ""},
      {"results", [](Forger& forger, Draw& draw) { forger.publish_results(draw.between(2, 50)); },
       "publishes about this run and is not its analysis"},
      {"statuses", [](Forger& forger, Draw& draw) { forger.fail_runs(draw.coin()); },
       "publishes about this run and is not its analysis"},
      {"measurements", [](Forger& forger, Draw& /*draw*/) { forger.abort_runs(); }, ""},
      {"commands", [](Forger& forger, Draw& /*draw*/) { forger.command_to_abort(); },
       "ended by a command of forger:"}};
  return all;
}

struct Vendors {
  std::string forger;
  std::string analysis;
  std::string others;
};

// Cyclone DDS, Fast DDS, and both.
Vendors vendors_of(std::size_t mix, Draw& draw) {
  const auto either = [&] { return draw.coin() ? "cyclonedds" : "fastdds"; };
  if (mix < 2) {
    const std::string one = mix == 0 ? "cyclonedds" : "fastdds";
    return {either(), one, one};
  }
  return draw.coin() ? Vendors{either(), "cyclonedds", "fastdds"}
                     : Vendors{either(), "fastdds", "cyclonedds"};
}

struct Ended {
  int status = -1;
  fs::path file;
  std::string errors;
  std::size_t heard = 0; // by the forger
  std::size_t forged = 0;

  [[nodiscard]] nlohmann::json result() const { return read_json(file); }
};

class Forgeries : public testing::TestWithParam<std::size_t> {
protected:
  static void SetUpTestSuite() {
    // Each test may be a process of its own, at the same time as others.
    folder = fresh_folder("forgeries-" + std::to_string(own_dds_domain()));
    bench = recorded_bench(folder, bench_name, "3");
    const Ended ended = run({"", "cyclonedds", "cyclonedds"}, nullptr, {});
    ASSERT_EQ(ended.status, 0) << ended.errors;
    undisturbed = ended.result();
    ASSERT_EQ(undisturbed["points"].size(), 18U);
  }
  // `secured`: folders of the programs; nullptr: plain. `begin`: what the forger does, from a drawn
  // instant on.
  static Ended run(const Vendors& vendors, const SecuredLaboratory* secured,
                   const std::function<void(Forger&)>& begin) {
    const auto options = [&](std::vector<std::string> words, const std::string& role) {
      return with_security(std::move(words), secured != nullptr ? secured->folder_of(role) : "");
    };
    static int runs = 0;
    const fs::path place = folder / std::to_string(++runs);
    Laboratory laboratory(place);
    laboratory.start("dyncal-analysis", options({}, "analysis"), vendors.analysis);
    laboratory.start("dyncal-acs", options({bench}, "source"), vendors.others);
    std::optional<Forger> forger;
    if (begin) {
      forger.emplace(vendors.forger, own_dds_domain(), bench_name);
    }
    ProgramRun& conductor = laboratory.start(
        "dyncal", options({"run", bench, "--output", place / "run.json"}, "operator"),
        vendors.others);
    if (forger) {
      EXPECT_TRUE(conductor.wait_for_error_text("run folder", patience)) << conductor.errors();
      begin(*forger);
    }
    Ended ended;
    ended.status = conductor.wait(patience).value_or(-1);
    if (forger) {
      forger->stop();
      ended.heard = forger->heard();
      ended.forged = forger->forged();
    }
    ended.file = place / "run.json";
    ended.errors = conductor.errors();
    return ended;
  }

  // A value that is another one has a flag, or is none.
  static std::size_t changed_without_a_flag(const nlohmann::json& result) {
    std::size_t changed = 0;
    for (const auto& point : result["points"]) {
      const auto same = [&](const auto& other) {
        return other["step"] == point["step"] && other["repetition"] == point["repetition"] &&
               other["channel"] == point["channel"];
      };
      const auto& all = undisturbed["points"];
      const auto known = std::find_if(all.begin(), all.end(), same);
      const bool is_same = known != all.end() && (*known)["magnitude"] == point["magnitude"] &&
                           (*known)["phase_rad"] == point["phase_rad"];
      changed += is_same || !point["valid"] || !point["flags"].empty() ? 0 : 1;
    }
    return changed;
  }
  void attack_once(const Attack& attack, std::size_t mix, unsigned seed, bool is_secured) {
    Draw draw{.number = seed * 100 + static_cast<unsigned>(GetParam() * 10 + mix)};
    const Vendors vendors = vendors_of(mix, draw);
    SCOPED_TRACE(fmt::format("{}, draw {}: forger {}, analysis {}, others {}", attack.name, seed,
                             vendors.forger, vendors.analysis, vendors.others));
    std::optional<SecuredLaboratory> secured;
    if (is_secured) {
      secured.emplace(fresh_folder("forgeries-secured-" + std::to_string(own_dds_domain())),
                      bench_name);
    }
    const Ended ended = run(vendors, secured ? &*secured : nullptr,
                            [&](Forger& forger) { attack.begin(forger, draw); });
    ++draws_;
    if (is_secured) {
      EXPECT_EQ(ended.heard, 0U);
      EXPECT_EQ(ended.status, 0) << ended.errors;
      EXPECT_EQ(ended.result()["points"], undisturbed["points"]);
      return;
    }
    EXPECT_GT(ended.forged, 0U);
    ended_ += ended.status == 0 ? 0 : 1;
    if (ended.status == 0) {
      EXPECT_EQ(ended.result()["points"].size(), undisturbed["points"].size());
    }
    EXPECT_EQ(changed_without_a_flag(ended.result()), 0U) << ended.errors;
    EXPECT_THAT(ended.errors, HasSubstr(attack.named));
  }
  void attack_all(bool is_secured) {
    const Attack& attack = attacks()[GetParam()];
    const char* wanted = std::getenv("DYNCAL_FORGERIES");
    const unsigned draws = wanted == nullptr ? 1 : static_cast<unsigned>(std::atoi(wanted));
    for (std::size_t mix = 0; mix < 3; ++mix) {
      if (wanted == nullptr && mix != (GetParam() + (is_secured ? 1 : 0)) % 3) {
        continue;
      }
      for (unsigned seed = 1; seed <= draws; ++seed) {
        attack_once(attack, mix, seed, is_secured);
      }
    }
    EXPECT_GE(draws_, draws);
    fmt::print("{}, {}: {} draws, {} runs ended\n", attack.name, is_secured ? "secured" : "plain",
               draws_, ended_);
  }

  static inline fs::path folder;
  static inline fs::path bench;
  static inline nlohmann::json undisturbed;
  std::size_t draws_ = 0;
  std::size_t ended_ = 0;
};

TEST_P(Forgeries, ChangeNoValueWithoutAFlagOrTheEndOfTheRun) {
  attack_all(false);
}

TEST_P(Forgeries, OfASecuredLaboratoryAreImpossible) {
  if (std::getenv("DYNCAL_FORGERIES") == nullptr && GetParam() > 1) {
    GTEST_SKIP() << "of the long form";
  }
  attack_all(true);
}

INSTANTIATE_TEST_SUITE_P(EachAttack, Forgeries, testing::Range<std::size_t>(0, 5),
                         [](const auto& one) { return std::string(attacks()[one.param].name); });

} // namespace
} // namespace dyncal::tests
