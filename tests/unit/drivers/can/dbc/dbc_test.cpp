#include "drivers/can/dbc/dbc.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "drivers/can/dbc/signal_decoder.hpp"

namespace dyncal::drivers::can {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

DbcFile parsed(const std::string& text) {
  auto file = parse_dbc(text, "sensor.dbc");
  EXPECT_TRUE(file) << file.error().message;
  return file.value_or(DbcFile{});
}

std::string refusal(const std::string& text) {
  const auto file = parse_dbc(text, "sensor.dbc");
  return file ? "accepted" : file.error().message;
}

const std::string accelerometer =
    "VERSION \"\"\r\n\r\nNS_ :\r\n\tCM_\r\n\tBA_\r\n\r\nBS_:\r\nBU_: Sensor Host\r\n\r\n"
    "BO_ 291 Acceleration: 8 Sensor\r\n"
    " SG_ x : 0|16@1- (0.001,0) [-32|32] \"m/s^2\" Host\r\n"
    " SG_ y : 23|16@0- (0.001,0) [0|0] \"m/s^2\" Host,\r\n Sensor\r\n"
    " SG_ counter:32|8@1+(1,0)[0|255]\"\" Vector__XXX\r\n";

TEST(Dbc, ReadsMessagesAndSignalsWithTheirLayout) {
  const DbcFile file = parsed(accelerometer);
  EXPECT_THAT(file.warnings, IsEmpty());
  ASSERT_EQ(file.messages.size(), 1U);
  const DbcMessage& message = file.messages.front();
  EXPECT_EQ(message.id, 291U);
  EXPECT_FALSE(message.extended);
  EXPECT_EQ(message.length_bytes, 8U);
  ASSERT_EQ(message.signals.size(), 3U);
  EXPECT_EQ(message.signals[1].order, ByteOrder::motorola);
  EXPECT_EQ(message.signals[1].start_bit, 23U);
  EXPECT_EQ(message.signals[1].type, RawType::signed_integer);
  EXPECT_EQ(message.signals[0].factor, 0.001);
  EXPECT_EQ(message.signals[0].unit, "m/s^2");
  EXPECT_EQ(message.signals[2].line, 14U);
}

TEST(Dbc, TakesSignsExponentsAndMissingLimitsAsFilesWriteThem) {
  const DbcFile file = parsed("BO_ 1 A: 8 S\n SG_ s : 0|8@1+ (+1E-006,-.5) [+1|-1] \"\" S\n");
  EXPECT_EQ(file.messages.at(0).signals.at(0).factor, 1e-6);
  EXPECT_EQ(file.messages.at(0).signals.at(0).offset, -0.5);
}

TEST(Dbc, DoesNotTakeThePseudoMessageOfUnusedSignalsForAFrame) {
  const DbcFile file = parsed("BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX\n SG_ a : "
                              "0|8@1+ (1,0) [0|0] \"\" Vector__XXX\n"
                              " SG_ a : 0|8@1+ (1,0) [0|0] \"\" Vector__XXX\n" +
                              accelerometer);
  ASSERT_EQ(file.messages.size(), 1U);
  EXPECT_EQ(file.messages.front().name, "Acceleration");
}

TEST(Dbc, KnowsExtendedIdsFrameFormatsCycleTimesAndLongNames) {
  const DbcFile file = parsed(
      "BO_ 2147483649 A: 8 S\n SG_ s : 0|8@1+ (1,0) [0|0] \"\" S\nBO_ 2 B: 64 S\n SG_ t : 504|8@1+ "
      "(1,0) [0|0] \"\" S\n"
      "BA_DEF_ BO_ \"VFrameFormat\" ENUM "
      "\"StandardCAN\",\"ExtendedCAN\",\"StandardCAN_FD\",\"J1939PG\";\n"
      "BA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\nBA_ \"VFrameFormat\" BO_ 2147483649 3;\n"
      "BA_ \"VFrameFormat\" BO_ 2 2;\nBA_ \"GenMsgCycleTime\" BO_ 2 10;\n"
      "BA_ \"SystemSignalLongSymbol\" SG_ 2 t \"acceleration_of_the_armature\";\n");
  EXPECT_TRUE(file.messages.at(0).extended);
  EXPECT_EQ(file.messages.at(0).id, 1U);
  EXPECT_EQ(file.messages.at(0).format, FrameFormat::j1939);
  EXPECT_EQ(file.messages.at(1).format, FrameFormat::standard_fd);
  EXPECT_DOUBLE_EQ(file.messages.at(1).cycle_time_s.value_or(0.0), 0.01);
  EXPECT_EQ(file.messages.at(1).signals.at(0).name, "acceleration_of_the_armature");
}

TEST(Dbc, ReadsWindows1252AndUtf8Units) {
  EXPECT_EQ(parsed("BO_ 1 A: 8 S\n SG_ s : 0|8@1+ (1,0) [0|0] \"\xb0/s\" S\n")
                .messages.at(0)
                .signals.at(0)
                .unit,
            "\u00b0/s");
  EXPECT_EQ(parsed("BO_ 1 A: 8 S\n SG_ s : 0|8@1+ (1,0) [0|0] \"\u00b0/s\" S\n")
                .messages.at(0)
                .signals.at(0)
                .unit,
            "\u00b0/s");
}

TEST(Dbc, PassesOverCommentsWithSemicolonsLineEndsAndQuotes) {
  const DbcFile file = parsed("CM_ \"one; two\nBO_ 9 Nothing: 8 S \\\" three\";\n" + accelerometer +
                              "CM_ SG_ 291 x \"ends in \\\";\n");
  EXPECT_EQ(file.messages.size(), 1U);
  EXPECT_THAT(file.warnings, IsEmpty());
}

TEST(Dbc, WarnsOfAnUnknownStatementAndReadsOn) {
  const DbcFile file = parsed("NEW_THING_ 1 2 \"a;b\" 3;\n" + accelerometer);
  EXPECT_EQ(file.messages.size(), 1U);
  ASSERT_EQ(file.warnings.size(), 1U);
  EXPECT_THAT(file.warnings[0],
              HasSubstr("sensor.dbc:1: passed over the unknown statement 'NEW_THING_'"));
}

TEST(Dbc, PassesOverCommentLines) {
  const DbcFile file = parsed("// made by hand; not by a tool\nBO_ 291 A: 8 S // sends\n"
                              " SG_ x : 0|16@1- (1,0) [0|0] \"m/s^2\" S\n"
                              " //SG_ old : 16|16@1- (1,0) [0|0] \"m/s^2\" S\n"
                              " SG_ z : 16|32@1- (1,0) [0|0] \"km//h\" S\n"
                              "BO_ 292 B: 8 S\n SG_ q : 0|16@1- (1,0) [0|0] \"\" S\n\n"
                              "// types\nSIG_VALTYPE_ 291 z : 1;\n");
  EXPECT_THAT(file.warnings, IsEmpty());
  ASSERT_EQ(file.messages.size(), 2U);
  ASSERT_EQ(file.messages[0].signals.size(), 2U);
  EXPECT_EQ(file.messages[0].signals[1].type, RawType::float32);
  EXPECT_EQ(file.messages[0].signals[1].unit, "km//h");
}

TEST(Dbc, AStatementWithoutSemicolonEndsWhereTheNextBegins) {
  const std::string message = "BO_ 291 A: 8 S\n SG_ z : 0|32@1- (1,0) [0|0] \"m/s^2\" S\n SG_ q : "
                              "32|8@1+ (1,0) [0|0] \"\" S\n";
  for (const std::string odd :
       {"CM_ SG_ 291 z \"no end\"", "VAL_ 291 q 0 \"zero\" 1 \"one\"", "FOREIGN_ 1 2 3",
        "BA_ \"GenMsgCycleTime\" BO_ 291 10", "BA_ \"GenMsgCycleTime\" BO_ 291",
        "BA_DEF_ BO_ \"Kind\" ENUM \"a\",\"b\"", "BA_DEF_DEF_ \"Kind\" \"a\"", "= garbage ="}) {
    const DbcFile file = parsed(message + odd + "\nSIG_VALTYPE_ 291 z : 1;\nBO_ 292 B: 8 S\n");
    ASSERT_EQ(file.messages.size(), 2U) << odd;
    EXPECT_EQ(file.messages[0].signals[0].type, RawType::float32) << odd;
    ASSERT_FALSE(file.warnings.empty()) << odd;
    EXPECT_THAT(file.warnings[0], HasSubstr("sensor.dbc:4: ")) << odd;
  }
}

TEST(Dbc, AStatementMayGoOnInTheNextLine) {
  const DbcFile file =
      parsed(accelerometer + "CM_\n SG_ 291 x\n \"text\";\nVAL_ 291 x 0 \"a\"\n 1 \"b\"\n;\n"
                             "BA_ \"GenMsgCycleTime\"\n BO_ 291\n 10;\nCM_ BU_ Host \"x\";\n");
  EXPECT_THAT(file.warnings, IsEmpty());
  EXPECT_EQ(file.messages.at(0).cycle_time_s, 0.01);
}

TEST(Dbc, ReadsNodesAndReceiversOnLinesOfTheirOwn) {
  const DbcFile file = parsed("BU_:\n\tSensor\n\tHost\n\n"
                              "BO_ 1 A: 8 S\n SG_ a : 0|8@1+ (1,0) [0|0] \"\" S,\n"
                              " SG_ b : 8|8@1+ (1,0) [0|0] \"\" S\n");
  EXPECT_THAT(file.warnings, IsEmpty());
  EXPECT_EQ(file.messages.at(0).signals.size(), 2U);
  const DbcFile unknown = parsed("BU_: A\nNEW_THING_ 1 2 \"x\";\nBO_ 1 A: 8 S\n");
  EXPECT_EQ(unknown.messages.size(), 1U);
  EXPECT_EQ(unknown.warnings.size(), 1U);
}

TEST(Dbc, TakesALimitBeyondANumberForNone) {
  for (const std::string limits :
       {"[0|1E+481]", "[-1.8e308|1.8e308]", "[-inf|inf]", "[0|1.#INF]"}) {
    const DbcFile file = parsed("BO_ 1 A: 8 S\n SG_ a : 0|8@1+ (1,0) " + limits + " \"V\" S\n");
    const DbcSignal& signal = file.messages.at(0).signals.at(0);
    EXPECT_EQ(signal.minimum, signal.maximum) << limits;
    EXPECT_EQ(signal.unit, "V") << limits;
  }
  EXPECT_THAT(refusal("BO_ 1 A: 8 S\n SG_ a : 0|8@1+ (1E+481,0) [0|1] \"V\" S\n"),
              HasSubstr("found '1E+481"));
}

TEST(Dbc, RefusesAFileWhereAQuotationMarkIsMissing) {
  EXPECT_THAT(refusal(accelerometer + "CM_ \"no end;\n"),
              HasSubstr("sensor.dbc:15: a quotation mark is missing"));
  EXPECT_THAT(refusal("CM_ \"no end;\nBO_ 9 B: 8 S\n SG_ s : 0|32@1- (1,0) [0|0] \"m/s^2\" S\n"
                      "CM_ \"x\";\n" +
                      accelerometer),
              HasSubstr("sensor.dbc:1: a quotation mark is missing"));
}

TEST(Dbc, ReadsSimpleMultiplexingWhereverTheSwitchStands) {
  const DbcFile file = parsed("BO_ 1 A: 8 S\n SG_ a m2 : 8|8@1+ (1,0) [0|0] \"\" S\n SG_ m M : "
                              "0|8@1+ (1,0) [0|0] \"\" S\n");
  const DbcSignal& a = file.messages.at(0).signals.at(0);
  ASSERT_TRUE(a.multiplexing);
  EXPECT_EQ(a.multiplexing->switch_signal, 1U);
  EXPECT_EQ(a.multiplexing->ranges.at(0), (std::pair<std::uint64_t, std::uint64_t>(2, 2)));
}

TEST(Dbc, ReadsCascadedMultiplexingWithRanges) {
  const DbcFile file = parsed("BO_ 1 A: 8 S\n SG_ top M : 0|8@1+ (1,0) [0|0] \"\" S\n SG_ below "
                              "m1M : 8|8@1+ (1,0) [0|0] \"\" S\n"
                              " SG_ leaf m3 : 16|8@1+ (1,0) [0|0] \"\" S\nSG_MUL_VAL_ 1 leaf below "
                              "3-5, 9-9;\nSG_MUL_VAL_ 1 below top 1-1;\n");
  const DbcMessage& message = file.messages.at(0);
  const auto state = [&](std::vector<std::uint8_t> data) {
    return decode_signal(message, message.signals[2], data).state;
  };
  EXPECT_EQ(state({1, 4, 7}), SignalState::valid);
  EXPECT_EQ(state({1, 9, 7}), SignalState::valid);
  EXPECT_EQ(state({1, 6, 7}), SignalState::absent);
  EXPECT_EQ(state({0, 4, 7}), SignalState::absent);
}

TEST(Dbc, RefusesWhatWouldDecodeWronglyWithFileAndLine) {
  EXPECT_THAT(refusal("\nBO_ x A: 8 S\n"), HasSubstr("sensor.dbc:2: BO_ must read"));
  EXPECT_THAT(refusal("BO_ 1 A: 8 S\n SG_ s : 0|8@2+ (1,0) [0|0] \"\" S\n"),
              HasSubstr("sensor.dbc:2: signal 's' must have 'start|length@order sign'"));
  EXPECT_THAT(refusal("BO_ 1 A: 8 S\n SG_ s : 0|8@1+ (1;0) [0|0] \"\" S\n"),
              HasSubstr("found ';0) [0|0]"));
  EXPECT_THAT(refusal("SG_ s : 0|8@1+ (1,0) [0|0] \"\" S\n"), HasSubstr("belongs to no message"));
  EXPECT_THAT(refusal("BO_ 4000 A: 8 S\n"), HasSubstr("id that no frame can have"));
  EXPECT_THAT(refusal("BO_ 1 A: 8 S\n SG_ s m0 : 0|8@1+ (1,0) [0|0] \"\" S\n"),
              HasSubstr("has no switch"));
  EXPECT_THAT(refusal("BO_ 1 A: 8 S\n SG_ a m0M : 0|8@1+ (1,0) [0|0] \"\" S\n SG_ b m0M : 8|8@1+ "
                      "(1,0) [0|0] \"\" S\n"
                      "SG_MUL_VAL_ 1 a b 0-0;\nSG_MUL_VAL_ 1 b a 0-0;\n"),
              HasSubstr("switches itself"));
  EXPECT_THAT(refusal("BO_ 1 A: 8 S\n SG_ s : 0|16@1- (1,0) [0|0] \"\" S\nSIG_VALTYPE_ 1 s : 1;\n"),
              HasSubstr("sensor.dbc:3: signal 's' is declared"));
  EXPECT_THAT(refusal("BO_ 1 A: 8 S\n SG_ s : 0|8@1+ (1,0) [0|0] \"m/s^2 S\n"),
              HasSubstr("sensor.dbc:2"));
}

TEST(Dbc, SaysWhatIsWrongWithAFileThatCannotBeRead) {
  const auto file = read_dbc_file("/nowhere/sensor.dbc");
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().code, ErrorCode::not_found);
  EXPECT_THAT(file.error().message, HasSubstr("/nowhere/sensor.dbc"));
  EXPECT_THAT(refusal("time,value\n0,1\n"), HasSubstr("this is not a DBC file"));
}

} // namespace
} // namespace dyncal::drivers::can
