#include "services/bench/file/reference_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/base/output_file.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A reference file as a laboratory writes it, each part by itself.
struct FileText {
  std::string reference = R"toml([reference]
name = "Reference standard accelerometer"
manufacturer = "Brüel & Kjær"
model = "8305"
serial = "1842876"
certificate = "PTB-17042-2022"
issued_by = "PTB"
issued = 2022-09-06
interval_months = 24
standard = "ISO 16063-21"
traceability = "National standard of Germany."
)toml";
  std::string response = R"toml([response]
unit = "pC/(m/s^2)"
k = 2
notes = ["at 8000 Hz: a resonance"]
rows = """
frequency_hz, level_m_s2, magnitude, phase_deg, U_magnitude_percent, U_phase_deg
10, 5, 0.13017, -0.02, 0.2, 0.2
80, 50, 0.13013, 0.01, 0.2, 0.2
"""
)toml";
  std::string amplifier = R"toml([amplifier]
name = "Charge amplifier"
serial = "1502245"
certificate = "A-17"
[amplifier.response]
unit = "mV/pC"
k = 2
file = "amplifier.csv"
)toml";
  std::string channel = R"toml([channel]
unit = "mV/(m/s^2)"
sensitivity = 0.13
)toml";

  [[nodiscard]] std::string text() const { return reference + response + amplifier + channel; }
};

class ReferenceFileTest : public testing::Test {
protected:
  Expected<ReferenceFile> read(const std::string& text, const std::string& name = "ref.toml") {
    std::filesystem::create_directories((folder_.path() / name).parent_path());
    EXPECT_TRUE(write_output_file(folder_.path() / name, text));
    NamedFiles files(folder_.path(), NamedFiles::Place::as_named);
    auto file = read_reference_file(name, files);
    named_.clear();
    for (const NamedFile& one : files.all()) {
      named_.push_back(one.name);
    }
    return file;
  }
  std::string problem_of(const std::string& text) {
    const auto file = read(text);
    EXPECT_FALSE(file) << text;
    return file ? "" : file.error().message;
  }
  void write_amplifier(const std::string& name = "amplifier.csv") {
    ASSERT_TRUE(write_output_file(folder_.path() / name,
                                  "frequency_hz,magnitude,phase_deg,U_magnitude_percent\n"
                                  "1,1,0,0.4\n20000,1,0,0.4\n"));
  }

  tests::TemporaryFolder folder_;
  std::vector<std::string> named_;
};

TEST_F(ReferenceFileTest, GivesTheChainAndItsCertificates) {
  write_amplifier();
  const auto file = read(FileText().text());
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->response.size(), 2U);
  EXPECT_NEAR(file->response[0].magnitude, 0.13017 / 0.13, 1e-12);
  EXPECT_NEAR(file->response[0].contributions.at(0).u_magnitude_rel, 1e-3, 1e-12);
  EXPECT_NEAR(file->response[0].contributions.at(1).u_magnitude_rel, 2e-3, 1e-12);
  EXPECT_THAT(file->notes, ElementsAre("at 8000 Hz: a resonance"));
  EXPECT_FALSE(file->phase_in_rad);
  ASSERT_EQ(file->standard.devices.size(), 2U);
  EXPECT_EQ(file->standard.devices[0].valid_until, "2024-09-06");
  EXPECT_EQ(file->standard.devices[1].certificate, "A-17");
  EXPECT_EQ(file->standard.file, "ref.toml");
  EXPECT_EQ(file->standard.file_sha256.size(), 64U);
  EXPECT_THAT(named_, ElementsAre("ref.toml", "amplifier.csv")); // what a run keeps copies of
}

TEST_F(ReferenceFileTest, LooksForItsTablesInItsOwnFolder) {
  std::filesystem::create_directories(folder_.path() / "calibration");
  write_amplifier("calibration/amplifier.csv");
  ASSERT_TRUE(read(FileText().text(), "calibration/ref.toml"));
  EXPECT_THAT(named_, ElementsAre("calibration/ref.toml", "calibration/amplifier.csv"));
}

// An interferometer reads right; its certificate is for documents.
TEST_F(ReferenceFileTest, NeedsNoResponse) {
  const auto file = read(FileText().reference);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_TRUE(file->response.empty());
  EXPECT_EQ(file->standard.devices.at(0).serial, "1842876");
}

TEST_F(ReferenceFileTest, TakesATableAlone) {
  const auto file = read("frequency_hz,magnitude,phase_rad\n10,1.002,-0.001\n", "ref.csv");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->response.at(0).magnitude, 1.002);
  EXPECT_TRUE(file->standard.devices.empty());
  EXPECT_TRUE(file->phase_in_rad);
}

TEST_F(ReferenceFileTest, SaysWhatIsWrong) {
  write_amplifier();
  FileText text;
  EXPECT_THAT(problem_of(text.response), HasSubstr("'reference' is missing"));
  EXPECT_THAT(problem_of(text.reference + text.response + text.amplifier),
              HasSubstr("'channel' is missing: sensitivity and unit"));
  EXPECT_THAT(problem_of(text.reference + text.response + text.channel),
              HasSubstr("a charge needs the table [amplifier]"));
  EXPECT_THAT(problem_of(text.text() + "[chanel]\n"), HasSubstr("'chanel'"));
  text.response = "[response]\nrows = \"frequency_hz, magnitude\"\n";
  EXPECT_THAT(
      problem_of(text.reference + text.response),
      HasSubstr("'response.rows' has a table that cannot be read: rows:1:1: the file has no "
                "points"));
  text.response = "[response]\nrows = \"frequency_hz, magnitude\\n10, 1\"\n";
  EXPECT_THAT(problem_of(text.reference + text.response + text.channel),
              HasSubstr("it is that of the whole chain"));
  text.response = "[response]\nunit = \"bananas\"\nrows = \"frequency_hz, magnitude\\n10, 1\"\n";
  EXPECT_THAT(problem_of(text.reference + text.response),
              HasSubstr("'response.unit' is \"bananas\""));
  EXPECT_THAT(problem_of(text.reference + "[response]\n"), HasSubstr("one of them"));
  text.reference += "valid_until = 2025-01-01\n";
  EXPECT_THAT(problem_of(text.reference), HasSubstr("stands in place of 'valid_until'"));
}

TEST_F(ReferenceFileTest, SendsADigitalCertificateToItsImport) {
  const auto file = read("<dcc/>", "8305.xml");
  ASSERT_FALSE(file);
  EXPECT_THAT(file.error().message, HasSubstr("dyncal import-reference"));
}

TEST_F(ReferenceFileTest, SaysThatItCannotBeRead) {
  NamedFiles files(folder_.path(), NamedFiles::Place::as_named);
  const auto file = read_reference_file("reference.csv", files);
  ASSERT_FALSE(file);
  EXPECT_THAT(file.error().message, HasSubstr("reference.csv: cannot be read"));
}

} // namespace
} // namespace dyncal::inline bench
