#include "services/bench/file/conditions_table.hpp"

#include <gmock/gmock.h>
#include <toml++/toml.h>

#include "services/bench/file/toml_text.hpp"

namespace dyncal::inline bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

const std::string file = "[conditions]\nkind = \"file\"\nfile = \"room.csv\"\n";
const std::string temperature = "temperature = \"Temp\"\nU_temperature_k = 0.4\n";

std::string problem_of(const std::string& text) {
  const auto parsed = parse_toml(text, "b.toml");
  BenchProblems problems;
  TomlTable root(*parsed, "", "b.toml", problems);
  static_cast<void>(read_condition_settings(root));
  return problems.empty() ? "" : problems.front().text();
}

TEST(ConditionsTable, NamesWhereEachQuantityIsFound) {
  const auto settings = condition_settings_of(
      file + "every_s = 30\nname = \"logger\"\n" + temperature +
      "humidity = \"rF\"\nU_humidity_percent = 3\npressure = \"4\"\nU_pressure_hpa = 1\n");
  ASSERT_TRUE(settings);
  EXPECT_EQ(settings->every_s, 30.0);
  EXPECT_EQ(settings->max_age_s, 600.0);
  EXPECT_EQ(settings->file, "room.csv");
  ASSERT_THAT(settings->quantities, SizeIs(3));
  EXPECT_EQ(settings->quantities[0].place, "Temp");
  EXPECT_EQ(settings->quantities[0].expanded, 0.4);
  EXPECT_EQ(settings->quantities[0].unit, "degC");
  EXPECT_EQ(settings->quantities[2].quantity, "pressure");
  const auto command =
      condition_settings_of("[conditions]\nkind = \"command\"\ncommand = [\"read\", \"all\"]\n");
  ASSERT_TRUE(command);
  EXPECT_THAT(command->command, ElementsAre("read", "all"));
  EXPECT_FALSE(condition_settings_of("bench = \"b\"\n"));
}

TEST(ConditionsTable, RefusesWhatIsNotMeant) {
  const std::string channel = "[conditions]\nkind = \"channel\"\n";
  EXPECT_THAT(problem_of(file + temperature), testing::IsEmpty());
  EXPECT_THAT(problem_of(channel + "file = \"x\"\n"), HasSubstr("file"));
  EXPECT_THAT(problem_of(channel + temperature), HasSubstr("SOURCE/CHANNEL"));
  EXPECT_THAT(problem_of(file + "temperature = \"T\"\n"), HasSubstr("U_temperature_k"));
  EXPECT_THAT(problem_of(file + "U_humidity_percent = 3\n"), HasSubstr("conditions.humidity"));
  EXPECT_THAT(problem_of(file + "temperature = \"T\"\nU_temperature_k = 0\n"),
              HasSubstr("above 0"));
  EXPECT_THAT(problem_of("[conditions]\nkind = \"file\"\n"), HasSubstr("conditions.file"));
  EXPECT_THAT(problem_of("[conditions]\nkind = \"command\"\n"), HasSubstr("command"));
  EXPECT_THAT(problem_of("[conditions]\nkind = \"moon\"\n"), HasSubstr("kind"));
  EXPECT_THAT(problem_of(file + "every_s = -1\n"), HasSubstr("every_s"));
  EXPECT_THAT(problem_of(file + "noise = \"x\"\n"), HasSubstr("noise"));
}

} // namespace
} // namespace dyncal::inline bench
