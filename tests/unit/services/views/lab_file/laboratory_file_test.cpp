#include "services/views/lab_file/laboratory_file.hpp"

#include <array>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>

namespace dyncal::inline views {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::filesystem::path example = std::filesystem::path(EXAMPLE_DOCUMENTS) / "laboratory.toml";

std::string example_text() {
  std::ifstream stream(example);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string problem_of(const std::string& text) {
  const auto file = parse_laboratory_file(text, example);
  return file ? "" : file.error().message;
}

// The example with one line replaced, which must be there.
std::string with(const std::string& line, const std::string& replacement) {
  std::string text = example_text();
  const std::size_t at = text.find(line);
  EXPECT_NE(at, std::string::npos) << line;
  return at == std::string::npos ? text : text.replace(at, line.size(), replacement);
}

TEST(LaboratoryFile, ReadsTheExample) {
  const auto file = read_laboratory_file(example);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->laboratory.name, "Example Laboratory for Vibration");
  EXPECT_EQ(file->laboratory.country, "DE");
  ASSERT_EQ(file->persons.size(), 2U);
  EXPECT_TRUE(file->persons[0].main_signer);
  EXPECT_FALSE(file->persons[1].main_signer);
  ASSERT_TRUE(file->reference);
  EXPECT_EQ(file->reference->standard, "ISO 16063-11");
  EXPECT_EQ(file->reference->devices.front().issued, "2026-02-03");
  EXPECT_EQ(file->reference->devices.front().valid_until, "2031-02-03");
  ASSERT_TRUE(file->conditions.temperature_degc);
  EXPECT_EQ(file->conditions.temperature_degc->value, 23.0);
  EXPECT_EQ(file->conditions.temperature_degc->expanded, 1.0);
  ASSERT_TRUE(file->logo);
  EXPECT_EQ(file->logo->mime_type, "image/svg+xml");
  EXPECT_EQ(file->equipment.size(), 1U);
}

TEST(LaboratoryFile, CountsTheIntervalOfTheReferenceInMonths) {
  const auto until = [](const std::string& issued, const std::string& validity) {
    const std::string text =
        with("issued = 2026-02-03\ninterval_months = 60", "issued = " + issued + "\n" + validity);
    const auto file = parse_laboratory_file(text, example);
    return file ? file->reference->devices.front().valid_until : file.error().message;
  };
  EXPECT_EQ(until("2026-02-03", "interval_months = 24"), "2028-02-03");
  EXPECT_EQ(until("2027-08-31", "interval_months = 6"), "2028-02-29"); // a leap year
  EXPECT_EQ(until("2026-12-31", "interval_months = 2"), "2027-02-28");
  EXPECT_EQ(until("2026-02-03", "valid_until = 2027-01-01"), "2027-01-01");
  EXPECT_EQ(until("2026-02-03", ""), "");
  EXPECT_THAT(until("2026-02-03", "valid_until = 2026-01-01"), HasSubstr("is before 'issued'"));
  EXPECT_THAT(until("2026-02-03", "valid_until = 2027-01-01\ninterval_months = 6"),
              HasSubstr("stands in place"));
}

TEST(LaboratoryFile, NamesFileLineAndKeyOfWhatIsMissing) {
  struct Missing {
    const char* line;
    const char* key;
  };
  constexpr std::array all{
      Missing{"name = \"Example Laboratory for Vibration\"", "laboratory.name"},
      Missing{"city = \"Musterstadt\"", "laboratory.city"},
      Missing{"name = \"Dr. Erika Mustermann\"", "person.name"},
      Missing{"name = \"Max Beispiel\"", "person.name"},
      Missing{"name = \"Sensor Works Example\"", "customer.name"},
      Missing{"city = \"Anytown\"", "customer.city"},
      Missing{"name = \"Laser vibrometer\"", "reference.name"},
      Missing{"serial = \"0815\"", "reference.serial"},
      Missing{"certificate = \"NMI-17-0001\"", "reference.certificate"},
      Missing{"issued_by = \"National Metrology Institute\"", "reference.issued_by"},
      Missing{"name = \"Vibration exciter\"", "equipment.name"},
      Missing{"U_temperature_k = 1.0", "conditions.U_temperature_k"},
      Missing{"temperature_degc = 23.0\n", "conditions.temperature_degc"},
      Missing{"U_humidity_percent = 10.0", "conditions.U_humidity_percent"},
  };
  for (const Missing& missing : all) {
    const std::string problem = problem_of(with(missing.line, ""));
    EXPECT_THAT(problem, StartsWith(example.string() + ":")) << missing.line;
    EXPECT_THAT(problem, HasSubstr(std::string("key '") + missing.key + "' is missing"))
        << missing.line;
    EXPECT_GT(std::atoi(problem.c_str() + example.string().size() + 1), 0) << problem;
  }
  EXPECT_THAT(problem_of("[customer]\nname='x'\ncity='y'\ncountry='DE'\n"),
              HasSubstr("key 'laboratory' is missing"));
  EXPECT_THAT(problem_of(""), HasSubstr("key 'laboratory' is missing"));
}

TEST(LaboratoryFile, RefusesWhatIsWrong) {
  EXPECT_THAT(problem_of(with("country = \"DE\"", "country = \"Germany\"")),
              HasSubstr("'laboratory.country' is \"Germany\" but must be two capital letters"));
  EXPECT_THAT(problem_of(with("standard = \"ISO 16063-11\"", "standard = \"ISO 9001\"")),
              HasSubstr("'reference.standard' is \"ISO 9001\" but must be one of"));
  EXPECT_THAT(problem_of(with("issued = 2026-02-03", "issued = \"3 Feb\"")),
              HasSubstr("must be a date"));
  EXPECT_THAT(problem_of(with("issued = 2026-02-03", "issued = \"2026-02-31\"")),
              HasSubstr("must be a date"));
  EXPECT_THAT(problem_of(with("humidity_percent = 45.0", "humidity_percent = 145.0")),
              HasSubstr("between 0 and 100"));
  EXPECT_THAT(problem_of(with("U_temperature_k = 1.0", "U_temperature_k = -1.0")),
              HasSubstr("must be above 0"));
  EXPECT_THAT(problem_of(with("city = \"Musterstadt\"", "city = \"  \"")),
              HasSubstr("must not be empty"));
  EXPECT_THAT(problem_of(with("city = \"Musterstadt\"", R"(city = "a\u0001b")")),
              HasSubstr("control character"));
  EXPECT_THAT(problem_of(with("accreditation =", "acreditation =")),
              HasSubstr("'laboratory.acreditation' is not known; did you mean 'accreditation'?"));
  EXPECT_THAT(problem_of(with("[[person]]", "[person]")), HasSubstr("not valid TOML"));
  EXPECT_THAT(problem_of("person = 3\n[laboratory]\nname='x'\ncity='y'\ncountry='DE'\n"),
              HasSubstr("must be a list of tables"));
  EXPECT_THAT(problem_of(with("logo = \"laboratory-logo.svg\"", "logo = \"none.svg\"")),
              HasSubstr("key 'laboratory.logo'"));
  EXPECT_THAT(problem_of("[laboratory\n"), HasSubstr(":1: not valid TOML"));
}

TEST(LaboratoryFile, IsNotAFolderAndNotEndless) {
  EXPECT_FALSE(read_laboratory_file("/"));
  EXPECT_FALSE(read_laboratory_file("/dev/zero"));
  EXPECT_FALSE(read_laboratory_file("/nowhere/lab.toml"));
}

} // namespace
} // namespace dyncal::inline views
