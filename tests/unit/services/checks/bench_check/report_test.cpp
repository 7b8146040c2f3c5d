#include "services/checks/bench_check/report.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/services/checks/bench_check/checked_bench.hpp"

namespace dyncal::inline checks::bench_check {
namespace {

const Findings findings{{Severity::note, "excitation", "has 3 steps", "a.toml", 3},
                        {Severity::error, "", "not valid TOML", "a.toml", 7}};

TEST(BenchCheckReport, OneLineAFinding) {
  EXPECT_EQ(as_text(findings), "a.toml:3: note: key 'excitation' has 3 steps\n"
                               "a.toml:7: error: not valid TOML\n"
                               "1 error, 0 warnings, 1 note\n");
}

TEST(BenchCheckReport, TextsMoveNoCursor) {
  const Findings hostile{{Severity::error,
                          "x\x1b[2J\n\xc2\x9b"
                          "2Jµ",
                          "is not known", "a.toml", 3}};
  EXPECT_EQ(as_text(hostile), "a.toml:3: error: key 'x?[2J??2Jµ' is not known\n"
                              "1 error, 0 warnings, 0 notes\n");
}

TEST(BenchCheckReport, Json) {
  const std::vector<BenchView> views{look_at_bench_text(smartup_bench, "a.toml")};
  const auto json = as_json(findings, views);
  EXPECT_EQ(json["status"], "error");
  EXPECT_EQ(json["benches"][0]["bench"], "acc-1");
  EXPECT_EQ(json["benches"][0]["sha256"].get<std::string>().size(), 64U);
  ASSERT_EQ(json["findings"].size(), 2U);
  EXPECT_EQ(json["findings"][0]["severity"], "note");
  EXPECT_EQ(json["findings"][0]["line"], 3);
  EXPECT_EQ(as_json({}, views)["status"], "ok");
}

} // namespace
} // namespace dyncal::inline checks::bench_check
