#include "services/views/certificate/reference_certificate.hpp"

#include <sstream>

#include <gmock/gmock.h>

#include "services/bench/file/reference_file.hpp"
#include "services/views/certificate/dcc_tables.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline views {
namespace {

using ::testing::HasSubstr;

// A certificate with one table, in the elements of a DCC; `lists` are its quantities.
std::string certificate_with(const std::string& lists, const std::string& name = "Sensitivity") {
  return R"(<?xml version="1.0" encoding="UTF-8"?>
<dcc:digitalCalibrationCertificate xmlns:dcc="https://ptb.de/dcc" xmlns:si="https://ptb.de/si"
    schemaVersion="3.3.0">
<dcc:administrativeData><dcc:coreData><dcc:uniqueIdentifier>u-1</dcc:uniqueIdentifier>
<dcc:endPerformanceDate>2026-03-01</dcc:endPerformanceDate></dcc:coreData>
<dcc:items><dcc:item><dcc:name><dcc:content lang="de">Aufnehmer</dcc:content>
<dcc:content lang="en">Accelerometer "A"</dcc:content></dcc:name><dcc:model>8305</dcc:model>
<dcc:identifications><dcc:identification refType="basic_serialNo"><dcc:value>77</dcc:value>
</dcc:identification></dcc:identifications></dcc:item></dcc:items>
<dcc:calibrationLaboratory><dcc:contact><dcc:name><dcc:content>NMI</dcc:content></dcc:name>
</dcc:contact></dcc:calibrationLaboratory></dcc:administrativeData>
<dcc:measurementResults><dcc:result><dcc:list><dcc:name><dcc:content>)" +
         name + "</dcc:content></dcc:name>" + lists +
         R"(</dcc:list></dcc:result></dcc:measurementResults></dcc:digitalCalibrationCertificate>)";
}

std::string list_of(const std::string& type, const std::string& values, const std::string& unit,
                    const std::string& uncertainty) {
  return "<dcc:quantity refType=\"" + type + "\"><si:realListXMLList><si:valueXMLList>" + values +
         "</si:valueXMLList><si:unitXMLList>" + unit + "</si:unitXMLList>" + uncertainty +
         "</si:realListXMLList></dcc:quantity>";
}

std::string expanded(const std::string& values, const std::string& k) {
  return "<si:measurementUncertaintyUnivariateXMLList><si:expandedMUXMLList>"
         "<si:valueExpandedMUXMLList>" +
         values + "</si:valueExpandedMUXMLList><si:coverageFactorXMLList>" + k +
         "</si:coverageFactorXMLList></si:expandedMUXMLList>"
         "</si:measurementUncertaintyUnivariateXMLList>";
}

const std::string frequencies = list_of("vibration_frequency", "10 20", R"(\hertz)", "");
const std::string voltage = R"(\milli\volt\metre\tothe{-1}\second\tothe{2})";

class ReferenceCertificateTest : public ::testing::Test {
protected:
  std::string import(const std::string& xml, const std::string& table = "") {
    const auto text = reference_file_of(folder_.write("dcc.xml", xml), table);
    return text ? *text : "FAILED " + text.error().message;
  }
  // The file that was made, read, after a person has added the channel.
  Expected<ReferenceFile> read(const std::string& text, const std::string& added) {
    folder_.write("reference.toml", text + added);
    NamedFiles files(folder_.path(), NamedFiles::Place::as_named);
    return read_reference_file("reference.toml", files);
  }

  tests::TemporaryFolder folder_;
};

TEST_F(ReferenceCertificateTest, KeepsDigitsAndIdentity) {
  const std::string text = import(certificate_with(
      frequencies +
      list_of("vibration_magnitude", "0.1301 0.13020", voltage, expanded("0.0003 0.0004", "2")) +
      list_of("vibration_phase", "-0.02 1.50", R"(\degree)", expanded("0.2", "2"))));
  EXPECT_THAT(text, HasSubstr("name = \"Accelerometer \\\"A\\\"\"\nmodel = \"8305\"\nserial = "
                              "\"77\"\ncertificate = \"u-1\"\nissued_by = \"NMI\"\nissued = "
                              "\"2026-03-01\"\n"));
  EXPECT_THAT(text, HasSubstr("frequency_hz, magnitude, U_magnitude, phase_deg, U_phase_deg, k\n"
                              "10, 0.1301, 0.0003, -0.02, 0.2, 2\n"
                              "20, 0.13020, 0.0004, 1.50, 0.2, 2\n"));
  const auto file = read(text, "[channel]\nunit = \"mV/(m/s^2)\"\nsensitivity = 0.13\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_NEAR(file->response.at(1).magnitude, 0.1302 / 0.13, 1e-15);
  EXPECT_NEAR(file->response.at(1).contributions.at(0).u_magnitude_rel, 0.0002 / 0.1302, 1e-15);
}

// Lists as of D-SI before 2.2, single values, another k of the phase, radians, no phase at all.
TEST_F(ReferenceCertificateTest, ReadsOtherForms) {
  const std::string older = "<si:expandedUncXMLList><si:uncertaintyXMLList>0.0003 0.0004"
                            "</si:uncertaintyXMLList><si:coverageFactorXMLList>2"
                            "</si:coverageFactorXMLList></si:expandedUncXMLList>";
  const std::string rows =
      import(certificate_with(frequencies + list_of("", "0.1301 0.1302", voltage, older) +
                              list_of("", "0.1 0.2", R"(\radian)", expanded("0.03 0.06", "3"))));
  EXPECT_THAT(rows, HasSubstr("frequency_hz, magnitude, U_magnitude, phase_rad, u_phase_rad, k\n"
                              "10, 0.1301, 0.0003, 0.1, 0.01, 2\n"));
  const std::string reals =
      "<dcc:quantity><si:list><si:real><si:value>0.5</si:value><si:unit>\\one</si:unit></si:real>"
      "<si:real><si:value>0.6</si:value><si:unit>\\one</si:unit></si:real></si:list></"
      "dcc:quantity>";
  std::string typed = reals;
  typed.insert(typed.find('>'), " refType=\"vibration_magnitude\"");
  const std::string plain = import(certificate_with(frequencies + typed));
  EXPECT_THAT(plain, HasSubstr("unit = \"1\""));
  EXPECT_THAT(plain, HasSubstr("frequency_hz, magnitude\n10, 0.5\n20, 0.6\n"));
}

TEST_F(ReferenceCertificateTest, NamesWhatItCannotUse) {
  const std::string magnitudes = list_of("vibration_magnitude", "1 2", voltage, "");
  EXPECT_THAT(import("<a/>"), HasSubstr("is no digital calibration certificate"));
  EXPECT_THAT(import(certificate_with("")), HasSubstr("has no table of magnitudes"));
  EXPECT_THAT(
      import(certificate_with(frequencies + list_of("vibration_magnitude", "1", voltage, ""))),
      HasSubstr("has no table of magnitudes")); // lengths differ
  EXPECT_THAT(import(certificate_with(frequencies +
                                      list_of("vibration_magnitude", "1 2", R"(\kelvin)", ""))),
              HasSubstr("'\\kelvin', is not that of a sensitivity"));
  for (const char* const unit : {R"(\kilo\hertz)", R"(\milli\hertz)", R"(\second)"}) {
    EXPECT_THAT(
        import(certificate_with(list_of("vibration_frequency", "1 2", unit, "") + magnitudes)),
        HasSubstr("frequency is in"))
        << unit;
  }
  for (const char* const unit : {R"(\milli\radian)", R"(\one)", R"(\second)"}) {
    EXPECT_THAT(import(certificate_with(frequencies + magnitudes +
                                        list_of("vibration_phase", "1 2", unit, ""))),
                HasSubstr("the phase is in"))
        << unit;
  }
  EXPECT_THAT(
      import(certificate_with(frequencies + list_of("vibration_magnitude", "1 x", voltage, ""))),
      HasSubstr("has no table of magnitudes"));
  // A level in another unit is not one of the table; without it the values are there.
  EXPECT_THAT(import(certificate_with(
                  frequencies + magnitudes +
                  list_of("vibration_accelerationAmplitude", "1 1", R"(\milli\volt)", ""))),
              HasSubstr("frequency_hz, magnitude\n10, 1\n"));
  const std::string twice =
      certificate_with(frequencies + magnitudes +
                       "</dcc:list><dcc:list><dcc:name><dcc:content>Second</dcc:content>"
                       "</dcc:name>" +
                       frequencies + magnitudes);
  EXPECT_THAT(import(twice), HasSubstr("choose one with --table: \"Sensitivity\", \"Second\""));
  EXPECT_THAT(import(twice, "Second"), HasSubstr("10, 1\n20, 2\n"));
}

// A certificate as a national institute writes it, where the folder with such is there.
TEST_F(ReferenceCertificateTest, ReadsOneOfANationalInstitute) {
  const std::filesystem::path path =
      std::filesystem::path(DYNCAL_SHARED_DCC) /
      "examples/PTB_8305_ce5174ed-7dd5-45a9-a607-12966290f823.stripped.xml";
  if (!std::filesystem::exists(path)) {
    GTEST_SKIP() << path << " is not there";
  }
  const auto text = reference_file_of(path, "");
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_THAT(*text, HasSubstr("name = \"Reference Standard Accelerometer\""));
  EXPECT_THAT(*text, HasSubstr("serial = \"1842876\"\ncertificate = \"PTB-17042-2022\""));
  EXPECT_THAT(*text, HasSubstr("issued = \"2022-09-06\""));
  EXPECT_THAT(*text, HasSubstr("unit = \"pC/(m/s^2)\""));
  EXPECT_THAT(*text, HasSubstr("notes = [\"at 8.0e+03 Hz: Between 7.5 kHz"));
  const auto file = read(*text, "[amplifier]\nname = \"amplifier\"\n[amplifier.response]\n"
                                "unit = \"mV/pC\"\nrows = \"frequency_hz, magnitude\\n1, 1\\n"
                                "20000, 1\"\n[channel]\nunit = \"mV/(m/s^2)\"\nsensitivity = "
                                "0.1\n");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->response.size(), 31U);
  const analysis::ReferenceCalibrationPoint& last = file->response.back();
  EXPECT_EQ(last.frequency_hz, 1e4);
  EXPECT_NEAR(last.magnitude, 0.14968 / 0.1, 1e-14);
  EXPECT_NEAR(last.phase_rad, -0.09 * std::acos(-1.0) / 180.0, 1e-15);
  EXPECT_NEAR(last.contributions.at(0).u_magnitude_rel, 0.00060 / 2.0 / 0.14968, 1e-15);
}

} // namespace
} // namespace dyncal::inline views
