#include "drivers/dso/oscilloscope.hpp"

#include <atomic>
#include <cmath>
#include <map>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/patience.hpp"
#include "tests/unit/drivers/dso/answering_instrument.hpp"

namespace dyncal::drivers::dso {
namespace {

using std::chrono::milliseconds;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr const char* identity = "RIGOL TECHNOLOGIES,MSO5072,MS5A000001,00.01.03.00.03";

// Answers as an MSO5072 with a trace of 1000 points that rises by one code a sample. `special`
// answers come first and are used up one after another.
class Scope {
public:
  std::vector<Piece> answer(const std::string& line) {
    if (auto found = special_.find(line); found != special_.end() && !found->second.empty()) {
      const std::vector<Piece> pieces = found->second.front();
      found->second.erase(found->second.begin());
      return pieces;
    }
    if (line.starts_with(":WAVeform:SOURce ")) {
      source_ = line.back();
    }
    if (line.starts_with(":WAVeform:STARt ")) {
      first_ = std::stoul(line.substr(16));
    }
    if (line.starts_with(":WAVeform:STOP ")) {
      last_ = std::stoul(line.substr(15));
    }
    if (!line.ends_with('?')) {
      return {};
    }
    if (line == "*IDN?") {
      return {{std::string(identity) + "\n"}};
    }
    if (line == ":SYSTem:ERRor?") {
      return {{"0,\"No error\"\n"}};
    }
    if (line == ":TRIGger:STATus?") {
      return {{"STOP\n"}};
    }
    if (line == ":WAVeform:SOURce?") {
      return {{std::string("CHAN") + source_ + "\n"}};
    }
    if (line == ":WAVeform:PREamble?") {
      return {{"0,2," + std::to_string(points_) +
               ",1,1.000000E-06,-1.000000E-04,0,5.000000E-02,0,128\n"}};
    }
    if (line == ":WAVeform:DATA?") {
      return {{block(last_ - first_ + 1)}};
    }
    return {{"\n"}};
  }
  void next(const std::string& line, std::vector<Piece> pieces) {
    special_[line].push_back(std::move(pieces));
  }
  void points(std::size_t points) { points_ = points; }

  static std::string block(std::size_t size) {
    std::string digits = std::to_string(size);
    std::string text = "#9" + std::string(9 - digits.size(), '0') + digits;
    for (std::size_t place = 0; place < size; ++place) {
      text.push_back(static_cast<char>(place % 251));
    }
    return text + "\n";
  }

private:
  std::map<std::string, std::vector<std::vector<Piece>>> special_;
  char source_ = '1';
  std::size_t first_ = 1;
  std::size_t last_ = 1000;
  std::size_t points_ = 1000;
};

class OscilloscopeTest : public testing::Test {
protected:
  void start(std::vector<InputSettings> inputs = {{"sync", 1, 20.0, 0.0}}) {
    instrument_ = std::make_unique<AnsweringInstrument>(
        [this](const std::string& line) { return scope_.answer(line); });
    OscilloscopeSettings settings;
    settings.address = instrument_->address();
    settings.inputs = std::move(inputs);
    settings.answer_limit = answer_limit_;
    oscilloscope_ = std::make_unique<Oscilloscope>(settings, stop_);
  }
  Expected<Shot> shoot() {
    DYNCAL_TRY(oscilloscope_->prepare(
        {.before_trigger_s = 1e-4, .after_trigger_s = 9e-4, .points = 1000}));
    return oscilloscope_->acquire(trigger_limit_);
  }
  // The shot fails with this, and the next one succeeds over a new connection.
  void expect_failure_then_recovery(ErrorCode code, const char* words) {
    const auto failed = shoot();
    ASSERT_FALSE(failed.has_value());
    EXPECT_EQ(failed.error().code, code) << failed.error().message;
    EXPECT_THAT(failed.error().message, HasSubstr(words));
    EXPECT_THAT(failed.error().message, HasSubstr(instrument_->address()));
    const auto shot = shoot();
    ASSERT_TRUE(shot.has_value()) << shot.error().message;
    EXPECT_EQ(shot->traces.at(0).volts.size(), 1000U);
    EXPECT_EQ(oscilloscope_->connections(), 2U);
  }

  milliseconds answer_limit_ = tests::patience;
  milliseconds trigger_limit_ = tests::patience;
  Scope scope_;
  StopSignal stop_;
  std::unique_ptr<AnsweringInstrument> instrument_;
  std::unique_ptr<Oscilloscope> oscilloscope_;
};

TEST_F(OscilloscopeTest, AShotHasTheTracesOfAllInputsOnOneTimeAxis) {
  start({{"sync", 1, 20.0, 0.0}, {"trigger", 2, 8.0, 2.0}});
  const auto shot = shoot();
  ASSERT_TRUE(shot.has_value()) << shot.error().message;
  EXPECT_DOUBLE_EQ(shot->first_sample_s, -1e-4);
  EXPECT_DOUBLE_EQ(shot->interval_s, 1e-6);
  ASSERT_EQ(shot->traces.size(), 2U);
  EXPECT_EQ(shot->traces[0].name, "sync");
  EXPECT_EQ(shot->traces[1].name, "trigger");
  EXPECT_DOUBLE_EQ(shot->traces[0].volts[0], -128.0 * 0.05);
  EXPECT_DOUBLE_EQ(shot->traces[0].volts[250], 122.0 * 0.05);
  EXPECT_EQ(oscilloscope_->identity(), identity);
}

TEST_F(OscilloscopeTest, TheInstrumentIsSetUpForTheShot) {
  start({{"sync", 1, 20.0, 0.0}, {"trigger", 2, 8.0, 2.0}});
  ASSERT_TRUE(shoot().has_value());
  const auto lines = instrument_->lines();
  for (const char* setting : {":SYSTem:AOUTput TOUT", ":CHANnel1:SCALe 5", ":CHANnel2:OFFSet -2",
                              ":TIMebase:MAIN:SCALe 0.0001", ":TIMebase:MAIN:OFFSet 0.0004",
                              ":ACQuire:MDEPth 1000", ":TRIGger:EDGE:SOURce CHANnel1",
                              ":TRIGger:EDGE:LEVel 0", ":SINGle", ":WAVeform:POINts 1000"}) {
    EXPECT_THAT(lines, Contains(std::string(setting)));
  }
}

TEST_F(OscilloscopeTest, AnAnswerMayComeInPiecesAndSlowly) {
  scope_.next("*IDN?", {{"RIGOL TECHNO"},
                        {"LOGIES,MSO5072,MS5A000001,", milliseconds(20)},
                        {"00.01.03.00.03\n", milliseconds(20)}});
  const std::string block = Scope::block(1000);
  scope_.next(":WAVeform:DATA?", {{block.substr(0, 1)},
                                  {block.substr(1, 5), milliseconds(20)},
                                  {block.substr(6, 500), milliseconds(20)},
                                  {block.substr(506), milliseconds(50)}});
  start();
  const auto shot = shoot();
  ASSERT_TRUE(shot.has_value()) << shot.error().message;
  EXPECT_DOUBLE_EQ(shot->traces[0].volts[999], (999 % 251 - 128.0) * 0.05);
  EXPECT_EQ(oscilloscope_->connections(), 1U);
}

TEST_F(OscilloscopeTest, ADeepMemoryIsReadInPartsThatTheInstrumentAllows) {
  scope_.points(600'000);
  start();
  const auto shot = shoot();
  ASSERT_TRUE(shot.has_value()) << shot.error().message;
  EXPECT_EQ(shot->traces[0].volts.size(), 600'000U);
  const auto lines = instrument_->lines();
  EXPECT_THAT(lines, Contains(std::string(":WAVeform:STARt 250001")));
  EXPECT_THAT(lines, Contains(std::string(":WAVeform:STOP 600000")));
}

TEST_F(OscilloscopeTest, AnInstrumentErrorIsPassedOnAsItIs) {
  start();
  ASSERT_TRUE(shoot().has_value());
  scope_.next(":SYSTem:ERRor?", {{"-222,\"Data out of range\"\n"}});
  const auto failed = shoot();
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().code, ErrorCode::refused);
  EXPECT_THAT(failed.error().message, HasSubstr("-222,\"Data out of range\""));
  EXPECT_THAT(failed.error().message, HasSubstr(":SINGle"));
  EXPECT_TRUE(shoot().has_value());
  EXPECT_EQ(oscilloscope_->connections(), 1U); // question and answer still belong together
}

TEST_F(OscilloscopeTest, AnUnknownInstrumentIsNamedAndTheKnownFamiliesAreListed) {
  scope_.next("*IDN?", {{"ACME,TOASTER,1,2\n"}});
  start();
  const auto failed = shoot();
  ASSERT_FALSE(failed.has_value());
  EXPECT_THAT(failed.error().message, HasSubstr("ACME,TOASTER,1,2"));
  EXPECT_THAT(failed.error().message, HasSubstr("rigol-mso5000"));
}

TEST_F(OscilloscopeTest, ATriggerThatNeverComesIsATimeoutAndTheConnectionStays) {
  for (int poll = 0; poll < 10'000; ++poll) {
    scope_.next(":TRIGger:STATus?", {{"WAIT\n"}});
  }
  start();
  trigger_limit_ = milliseconds(200);
  const auto failed = shoot();
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().code, ErrorCode::timeout);
  EXPECT_THAT(failed.error().message, HasSubstr("no trigger within 200 ms"));
  EXPECT_EQ(instrument_->lines().at(instrument_->lines().size() - 2), ":STOP");
  EXPECT_EQ(oscilloscope_->connections(), 1U);
}

TEST_F(OscilloscopeTest, HalfABlockIsATimeoutAndTheNextShotConnectsAnew) {
  answer_limit_ = milliseconds(2000);
  start();
  scope_.next(":WAVeform:DATA?", {{Scope::block(1000).substr(0, 300)}});
  expect_failure_then_recovery(ErrorCode::timeout, "does not answer");
}

TEST_F(OscilloscopeTest, ACablePulledInTheMiddleOfABlockIsADisconnection) {
  start();
  scope_.next(":WAVeform:DATA?", {{Scope::block(1000).substr(0, 300), milliseconds(0), true}});
  expect_failure_then_recovery(ErrorCode::disconnected, "closed the connection");
}

TEST_F(OscilloscopeTest, GarbageInsteadOfABlockIsMalformed) {
  start();
  scope_.next(":WAVeform:DATA?", {{"\x01\x02 garbage\n"}});
  expect_failure_then_recovery(ErrorCode::malformed, "does not begin a block");
}

TEST_F(OscilloscopeTest, ABlockLongerThanItSaysIsMalformed) {
  start();
  std::string block = Scope::block(1000);
  block.insert(block.size() - 1, "xyz");
  scope_.next(":WAVeform:DATA?", {{block}});
  expect_failure_then_recovery(ErrorCode::malformed, "longer than the 1000 bytes");
}

TEST_F(OscilloscopeTest, ABlockOfAnotherLengthThanAskedForIsMalformed) {
  start();
  scope_.next(":WAVeform:DATA?", {{Scope::block(999)}});
  expect_failure_then_recovery(ErrorCode::malformed, "999 bytes where 1000");
}

TEST_F(OscilloscopeTest, AnAnswerToAnotherCommandIsNoticed) {
  start();
  scope_.next(":WAVeform:SOURce?", {{"WAIT\n"}});
  expect_failure_then_recovery(ErrorCode::malformed, ":WAVeform:SOURce? with 'WAIT'");
}

TEST_F(OscilloscopeTest, AnAnswerThatNobodyAskedForIsNoticed) {
  start();
  scope_.next(":WAVeform:SOURce?", {{"CHAN1\nCHAN1\n"}});
  expect_failure_then_recovery(ErrorCode::malformed, "was not asked");
}

TEST_F(OscilloscopeTest, APreambleThatIsNoneIsMalformed) {
  start();
  scope_.next(":WAVeform:PREamble?", {{"0,\"No error\"\n"}});
  expect_failure_then_recovery(ErrorCode::malformed, "preamble");
}

TEST_F(OscilloscopeTest, AnInstrumentThatIsSwitchedOffComesBackByItself) {
  start();
  ASSERT_TRUE(shoot().has_value());
  scope_.next(":SINGle", {{"", milliseconds(0), true}});
  expect_failure_then_recovery(ErrorCode::disconnected, "closed the connection");
  EXPECT_EQ(instrument_->lines().at(0), "*CLS");
}

TEST_F(OscilloscopeTest, AStopSignalEndsTheWaitForATrigger) {
  for (int poll = 0; poll < 10'000; ++poll) {
    scope_.next(":TRIGger:STATus?", {{"WAIT\n"}});
  }
  start();
  ASSERT_TRUE(
      oscilloscope_->prepare({.before_trigger_s = 1e-4, .after_trigger_s = 9e-4, .points = 1000})
          .has_value());
  std::thread stopper([this] { stop_.raise(); });
  const auto failed = oscilloscope_->acquire(std::chrono::minutes(5));
  stopper.join();
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().code, ErrorCode::disconnected);
}

TEST(ScopeStep, IsTheNextOfTheOneTwoFiveSeries) {
  EXPECT_DOUBLE_EQ(next_scope_step(0.1), 0.1);
  EXPECT_DOUBLE_EQ(next_scope_step(0.11), 0.2);
  EXPECT_DOUBLE_EQ(next_scope_step(2.4375), 5.0);
  EXPECT_DOUBLE_EQ(next_scope_step(6e-7), 1e-6);
}

} // namespace
} // namespace dyncal::drivers::dso
