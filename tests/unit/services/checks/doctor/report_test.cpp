#include "services/checks/doctor/report.hpp"

#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace dyncal::inline checks::doctor {
namespace {

const Finding fine{Severity::ok, "disk", "100 MB are free"};
const Finding warning{Severity::warning, "clocks", "the clock of lab-2 is far"};
const Finding problem{Severity::error, "sources", "source acc-1/dau is silent"};

TEST(DoctorReport, HasALineForEachFinding) {
  EXPECT_EQ(as_text({problem, warning, fine}), "PROBLEM  sources     source acc-1/dau is silent\n"
                                               "WARNING  clocks      the clock of lab-2 is far\n"
                                               "ok       disk        100 MB are free\n"
                                               "1 problem, 1 warning\n");
  EXPECT_EQ(as_text({fine}), "ok       disk        100 MB are free\nnothing is wrong\n");
}

TEST(DoctorReport, ShowsWhatWasForgedAsOneHarmlessLine) {
  const Finding forged{Severity::ok, "programs", "a\x1b[2J\nok\xff: dyncal 0.2.0"};
  EXPECT_EQ(as_text({forged}),
            "ok       programs    a?[2J?ok\xef\xbf\xbd: dyncal 0.2.0\nnothing is wrong\n");
}

TEST(DoctorReport, ShowsATextOf100KilobytesAsOneShortLine) {
  const Finding forged{Severity::ok, "programs", std::string(100'000, '\n') + "dyncal 0.2.0"};
  const std::string text = as_text({forged});
  EXPECT_LT(text.size(), 1100U);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  LaboratoryView view;
  view.programs = {{{std::string(100'000, '\x1b'), std::string(100'000, 'h'), 3, "", ""}, 1, {}}};
  const auto json = as_json({forged}, view);
  EXPECT_LT(json.dump().size(), 5000U);
  EXPECT_EQ(json["findings"][0]["sentence"].get<std::string>().find('\n'), std::string::npos);
}

TEST(DoctorReport, HasAllOfItAsJson) {
  LaboratoryView view;
  view.domain = 7;
  view.programs = {{{"dyncal-acs", "lab-2", 3, "dyncal 0.2.0", "fastdds"}, 1, {}}};
  view.clocks = {{"lab-2", {.offset_s = 0.25, .bound_s = 0.5}}};
  view.losses = {{.identity = {"dyncal-acs", "lab-2", 3, "", ""},
                  .answers_probes = true,
                  .sent = 200,
                  .echoed = 150},
                 {.answers_probes = true, .sent = 3, .echoed = 1}};
  view.sources[{"acc-1", "dau"}].state = network::SourceState::silent;
  view.discovery.participants = {{"0110", "dyncal-acs", "Cyclone DDS"}};
  view.announced_by_multicast.emplace();
  const auto json = as_json({problem, fine}, view);
  EXPECT_EQ(json["status"], "problem");
  EXPECT_EQ(json["domain"], 7);
  EXPECT_EQ(json["findings"].size(), 2U);
  EXPECT_EQ(json["findings"][0]["severity"], "problem");
  EXPECT_EQ(json["findings"][0]["check"], "sources");
  EXPECT_EQ(json["programs"][0]["program"], "dyncal-acs");
  EXPECT_EQ(json["clocks"][0]["offset_s"], 0.25);
  EXPECT_EQ(json["losses"][0]["program"], "dyncal-acs");
  EXPECT_EQ(json["losses"][0]["probes"], 200);
  EXPECT_EQ(json["losses"][0]["echoes"], 150);
  EXPECT_EQ(json["losses"][0]["lost_percent"], 25.0);
  EXPECT_TRUE(json["losses"][1]["lost_percent"].is_null()) << "of too few";
  EXPECT_EQ(json["sources"][0]["state"], "silent");
  EXPECT_EQ(json["participants"][0]["by_multicast"], false);
}

} // namespace
} // namespace dyncal::inline checks::doctor
