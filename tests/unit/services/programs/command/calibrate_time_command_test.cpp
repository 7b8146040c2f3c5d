#include <filesystem>
#include <fstream>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "services/programs/command/command.hpp"
#include "services/programs/command/pulse_file.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline programs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const Command calibrate_command{260, "calibrate", "what it is below"};

class CalibrateTime : public ::testing::Test {
protected:
  fs::path file(const std::string& name, const std::string& text) const {
    return own_.write(name, text);
  }
  // What `dyncal calibrate time FILE` writes; null where it fails.
  nlohmann::json calibrated(const fs::path& record) const {
    CLI::App app;
    Command::Action chosen;
    add_commands(app, chosen);
    const std::string output = folder_ / "time.json";
    app.parse(fmt::format("calibrate time {} --output {}", record.string(), output));
    const auto status = chosen();
    EXPECT_TRUE(status) << status.error().message;
    std::ifstream stream(output);
    return status == 0 ? nlohmann::json::parse(stream) : nlohmann::json();
  }
  static std::string error_of(const std::vector<fs::path>& files) {
    const auto read = read_pulse_files(files);
    return read ? "" : read.error().message;
  }

  const tests::TemporaryFolder own_;
  const fs::path& folder_ = own_.path();
};

// 14 s of a real record at 100 MHz: the counter wraps at the end.
constexpr const char* extract = "GPST;0;3094019184\nREFT;0;3134801829\nGPST;1;3194018485\nREFT;1;"
                                "3234801126\nGPST;2;3294017780\n"
                                "REFT;2;3334800421\nGPST;3;3394017074\nREFT;3;3434799717\nGPST;4;"
                                "3494016371\nREFT;4;3534799013\n"
                                "GPST;5;3594015667\nREFT;5;3634798310\nGPST;6;3694014964\nREFT;6;"
                                "3734797608\nGPST;7;3794014263\n"
                                "REFT;7;3834796906\nGPST;8;3894013561\nREFT;8;3934796205\nGPST;9;"
                                "3994012861\nREFT;9;4034795504\n";

TEST_F(CalibrateTime, AnExtractOfARealRecordIsJudged) {
  const auto json = calibrated(file("pps.csv", extract));
  EXPECT_EQ(json["gps"]["seconds"], 10);
  EXPECT_EQ(json["reference"]["seconds"], 10);
  EXPECT_EQ(json["deviation"]["untrusted"], 2);
  EXPECT_EQ(json["deviation"]["count"], 8);
  EXPECT_NEAR(json["deviation"]["reference_offset_s"].get<double>(), 0.4078293, 1e-6);
  EXPECT_LT(json["deviation"]["spread_s"].get<double>(), 60e-9);
  EXPECT_FALSE(json["deviation"].contains("mean_s"));
  EXPECT_TRUE(fs::exists(folder_ / "time.svg"));
  EXPECT_TRUE(fs::exists(folder_ / "time.csv"));
}

TEST_F(CalibrateTime, SeveralFilesAreOneRecord) {
  const std::string text = extract;
  const std::size_t middle = text.find("GPST;5");
  const auto record =
      read_pulse_files(std::vector{file("a.csv", text.substr(0, middle)),
                                   file("b.csv", "# second part\r\n\r\n" + text.substr(middle))});
  ASSERT_TRUE(record);
  EXPECT_EQ(record->edges.size(), 20U);
  EXPECT_EQ(record->place(10), "b.csv: line 3");
}

TEST_F(CalibrateTime, ARecordOfGpsPulsesAloneHasNoDeviation) {
  const auto json =
      calibrated(file("gps.csv", "0;184302183\n1;284301456\n2;384300731\n3;484300007\n4;504098362\n"
                                 "5;584299284\n6;639117152\n7;684298561\n"));
  EXPECT_EQ(json["gps"]["extra"], 2);
  EXPECT_EQ(json["gps"]["seconds"], 6);
  EXPECT_FALSE(json.contains("deviation"));
  EXPECT_THAT(json["events"][0]["place"].get<std::string>(), HasSubstr("gps.csv: line 5"));
  EXPECT_FALSE(fs::exists(folder_ / "time.svg"));
}

TEST_F(CalibrateTime, WhatIsNoEdgeIsAnErrorWithFileAndLine) {
  EXPECT_THAT(
      error_of({file("a.csv", "GPST;0;1\nGPST;1;x\n")}),
      HasSubstr("a.csv: line 2: 'GPST;1;x' is not an edge: expected GPST;n;ticks or REFT;n;ticks"));
  EXPECT_THAT(error_of({file("b.csv", "GPST;0;1\n1;2\n")}), HasSubstr("b.csv: line 2"));
  EXPECT_THAT(error_of({file("c.csv", "0;1\nREFT;1;2\n")}),
              HasSubstr("'REFT;1;2' is not an edge: expected n;ticks"));
  EXPECT_THAT(error_of({file("d.csv", "GPST;0;-1\n")}), HasSubstr("line 1"));
  EXPECT_THAT(error_of({file("e.csv", "GPST;0;99999999999999999999999\n")}), HasSubstr("line 1"));
  EXPECT_THAT(error_of({file("f.csv", "GPST;0;1;2\n")}), HasSubstr("line 1"));
  EXPECT_THAT(error_of({file("g.csv", "GPST;13")}), HasSubstr("line 1"));
  EXPECT_THAT(error_of({file("h.csv", "# nothing\n")}), HasSubstr("holds no edges"));
  EXPECT_THAT(error_of({folder_ / "absent.csv"}), HasSubstr("cannot be opened"));
}

TEST_F(CalibrateTime, TheRealRecordsAreReadWithTheirKnownFaults) {
  const fs::path shared = fs::path(DYNCAL_SHARED_DATA) / "pps";
  if (!fs::exists(shared)) {
    GTEST_SKIP() << "no real pulse records at " << shared;
  }
  auto json = calibrated(shared / "gps-and-reference-pps-short.csv");
  EXPECT_EQ(json["sessions"], 3);
  EXPECT_EQ(json["gps"]["seconds"], 134);
  EXPECT_EQ(json["reference"]["seconds"], 133);
  EXPECT_EQ(json["gps"]["extra"], 0);
  EXPECT_EQ(json["deviation"]["untrusted"], 7);
  EXPECT_LT(json["deviation"]["spread_s"].get<double>(), 1e-6);

  json = calibrated(shared / "gps-pps-glitches.csv");
  EXPECT_EQ(json["sessions"], 1);
  EXPECT_EQ(json["gps"]["extra"], 3);
  EXPECT_EQ(json["gps"]["missing"], 1);
  EXPECT_EQ(json["gps"]["seconds"], 2506);
}

} // namespace
} // namespace dyncal::inline programs
