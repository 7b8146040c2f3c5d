#include "drivers/generator/scpi_generator.hpp"

#include <atomic>
#include <future>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mutex>
#include <optional>
#include <vector>

#include "tests/unit/drivers/link/scripted_instrument.hpp"

namespace dyncal::drivers::generator {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Answers as a DG4000 does; `errors` are what it says to the next error queries, "0,No error" when
// they are used up.
class FakeGenerator {
public:
  explicit FakeGenerator(std::vector<std::string> errors = {},
                         std::string identity = "Rigol Technologies,DG4162,DG4E1,00.01.14")
      : errors_(std::move(errors)), identity_(std::move(identity)),
        instrument_([this](int, ScriptedInstrument::Client& client) { serve(client); }) {}

  [[nodiscard]] std::string address() const { return instrument_.address(); }
  [[nodiscard]] std::vector<std::string> commands() {
    const std::lock_guard lock(mutex_);
    return commands_;
  }
  [[nodiscard]] std::vector<std::string> questions() {
    const std::lock_guard lock(mutex_);
    return questions_;
  }
  // Takes :OUTPut1 OFF without an error, and stays on.
  void ignore_off() {
    const std::lock_guard lock(mutex_);
    ignores_off_ = true;
  }
  // Instead of hearing the next line.
  void hang_up() { hangs_up_ = true; }
  // To every other question; nothing: none at all.
  void answer_questions(const std::optional<std::string>& answer) {
    const std::lock_guard lock(mutex_);
    other_answer_ = answer;
  }
  void always_answer_output(const std::string& answer) {
    const std::lock_guard lock(mutex_);
    output_answer_ = answer;
  }

private:
  void serve(ScriptedInstrument::Client& client) {
    for (std::string line = client.hear(); !line.empty(); line = client.hear()) {
      if (hangs_up_.exchange(false)) {
        return;
      }
      const std::lock_guard lock(mutex_);
      if (line == "*IDN?") {
        client.say(identity_ + "\r\n");
      } else if (line == ":SYSTem:ERRor?") {
        client.say((answered_ < errors_.size() ? errors_[answered_] : "0,\"No error\"") + "\n");
        ++answered_;
      } else if (line == ":BENCh:TIME?") {
        client.say("12.5\n");
      } else if (line.starts_with(":BENCh:WAIT?")) {
        client.say(line.substr(13) + "\n");
      } else if (line == ":OUTPut1?") {
        client.say(output_answer_.value_or(is_on_ ? "ON" : "OFF") + "\n");
      } else if (line.ends_with("?")) {
        questions_.push_back(line);
        if (other_answer_) {
          client.say(*other_answer_ + "\n");
        }
      } else {
        is_on_ = line == ":OUTPut1 ON" || (is_on_ && (ignores_off_ || line != ":OUTPut1 OFF"));
        commands_.push_back(line);
      }
    }
  }

  std::atomic<bool> hangs_up_ = false;
  std::mutex mutex_;
  bool is_on_ = false;
  bool ignores_off_ = false;
  std::optional<std::string> output_answer_; // always this one
  std::optional<std::string> other_answer_ = "0";
  std::vector<std::string> questions_;
  std::vector<std::string> errors_;
  std::size_t answered_ = 0;
  std::string identity_;
  std::vector<std::string> commands_;
  ScriptedInstrument instrument_;
};

TEST(ScpiGenerator, SetsTheInstrumentUpAndSwitchesItsOutputOffAtTheEnd) {
  FakeGenerator instrument;
  {
    auto generator = ScpiGenerator::connect(instrument.address());
    ASSERT_TRUE(generator) << generator.error().message;
    EXPECT_EQ((*generator)->identity(), "Rigol Technologies,DG4162,DG4E1,00.01.14");
    EXPECT_TRUE((*generator)->set_frequency("199.87"));
    EXPECT_TRUE((*generator)->set_amplitude_v(0.25));
    EXPECT_TRUE((*generator)->set_output(true));
  }
  EXPECT_THAT(instrument.commands(),
              ElementsAre(":OUTPut1 OFF", ":OUTPut1 OFF", ":OUTPut1:LOAD INFinity",
                          ":SOURce1:FUNCtion SINusoid", ":SOURce1:VOLTage:UNIT VPP",
                          ":SOURce1:BURSt:STATe OFF", ":SOURce1:SWEep:STATe OFF",
                          ":SOURce1:MOD:STATe OFF", ":SOURce1:VOLTage:OFFSet 0", ":SOURce1:PHASe 0",
                          ":OUTPut1:POLarity NORMal", ":SOURce1:FREQuency 199.87",
                          ":SOURce1:VOLTage 0.5", ":OUTPut1 ON", ":OUTPut1 OFF"));
}

TEST(ScpiGenerator, ReadsBackWhatItHasReset) {
  FakeGenerator instrument;
  auto generator = ScpiGenerator::connect(instrument.address());
  ASSERT_TRUE(generator) << generator.error().message;
  EXPECT_THAT(instrument.questions(),
              ElementsAre(":SOURce1:BURSt:STATe?", ":SOURce1:SWEep:STATe?", ":SOURce1:MOD:STATe?",
                          ":SOURce1:VOLTage:OFFSet?", ":SOURce1:PHASe?", ":OUTPut1:POLarity?"));
}

TEST(ScpiGenerator, RefusesAnInstrumentThatKeepsWhatWasLeftInIt) {
  FakeGenerator instrument;
  instrument.answer_questions("ON");
  const auto generator = ScpiGenerator::connect(instrument.address());
  ASSERT_FALSE(generator);
  EXPECT_EQ(generator.error().code, ErrorCode::refused);
  EXPECT_THAT(generator.error().message, HasSubstr("what another program left in it (burst)"));
  EXPECT_THAT(instrument.commands(), testing::Not(testing::Contains(":OUTPut1 ON")));
}

TEST(ScpiGenerator, GoesOnWithAnUnknownInstrumentThatAnswersNoSuchQuestion) {
  FakeGenerator instrument({}, "Maker,Model 7,1,2");
  instrument.answer_questions(std::nullopt);
  auto generator = ScpiGenerator::connect(instrument.address());
  ASSERT_TRUE(generator) << generator.error().message;
  EXPECT_EQ(instrument.questions().size(), 1U); // and no other after it
  EXPECT_THAT(instrument.commands(), testing::Contains(":SOURce1:AM:STATe OFF"));
  EXPECT_TRUE((*generator)->set_output(true));
}

TEST(ScpiGenerator, RefusesAnUnknownInstrumentWhoseAnswerContradicts) {
  FakeGenerator instrument({}, "Maker,Model 7,1,2");
  instrument.answer_questions("1");
  EXPECT_EQ(ScpiGenerator::connect(instrument.address()).error().code, ErrorCode::refused);
}

TEST(ScpiGenerator, KeepsPeakAndOffsetWithinTheLimit) {
  FakeGenerator instrument;
  auto generator = ScpiGenerator::connect(instrument.address(), 0.5);
  ASSERT_TRUE(generator) << generator.error().message;
  EXPECT_TRUE((*generator)->set_amplitude_v(0.5));
  EXPECT_TRUE((*generator)->set_output(true));
  EXPECT_EQ((*generator)->set_amplitude_v(0.51).error().code, ErrorCode::invalid_setting);
  EXPECT_TRUE((*generator)->set_output(false));
  instrument.answer_questions("-9E-4"); // as far as an instrument rounds
  EXPECT_EQ((*generator)->set_output(true).error().code, ErrorCode::invalid_setting);
  EXPECT_TRUE((*generator)->set_amplitude_v(0.499));
  EXPECT_TRUE((*generator)->set_output(true));
  EXPECT_EQ((*generator)->set_amplitude_v(0.4995).error().code, ErrorCode::invalid_setting);
  EXPECT_TRUE((*generator)->set_output(false));
  instrument.answer_questions("0.3");
  const auto refused = (*generator)->set_output(true);
  EXPECT_THAT(refused.error().message, HasSubstr("its DC offset is 0.3 V"));
  EXPECT_FALSE((*generator)->output_is_on().value().value());
}

TEST(ScpiGenerator, PassesTheInstrumentsErrorOnWordForWord) {
  std::vector<std::string> errors(10, "0,\"No error\"");
  errors[1] = "+0,\"No error\"";
  errors[5] = "-113,\"Undefined header\""; // a reset of a state that it does not have
  errors.emplace_back("-222,\"Data out of range\"");
  FakeGenerator instrument(errors);
  auto generator = ScpiGenerator::connect(instrument.address());
  ASSERT_TRUE(generator) << generator.error().message;
  const auto refused = (*generator)->set_frequency("1e12");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::refused);
  EXPECT_THAT(refused.error().message,
              HasSubstr(":SOURce1:FREQuency 1e12: -222,\"Data out of range\""));
}

TEST(ScpiGenerator, TakesTheHostsClockWhereTheInstrumentHasNone) {
  FakeGenerator instrument;
  auto generator = ScpiGenerator::connect(instrument.address());
  ASSERT_TRUE(generator) << generator.error().message;
  const auto begin_s = (*generator)->clock_now_s();
  ASSERT_TRUE(begin_s);
  EXPECT_LT(*begin_s, 5.0);
  const auto end_s = (*generator)->wait_until_s(*begin_s + 0.05, {});
  ASSERT_TRUE(end_s);
  EXPECT_GE(*end_s, *begin_s + 0.05);
}

TEST(ScpiGenerator, NoticesInAStepThatItsOutputWasSwitchedOff) {
  FakeGenerator instrument;
  auto generator = ScpiGenerator::connect(instrument.address());
  ASSERT_TRUE(generator) << generator.error().message;
  ASSERT_TRUE((*generator)->set_output(true));
  const auto wait = [&] {
    return (*generator)->wait_until_s(1.05 + *(*generator)->clock_now_s(), {});
  };
  ASSERT_TRUE(wait());
  instrument.always_answer_output("OFF");
  const auto held = wait();
  ASSERT_FALSE(held);
  EXPECT_EQ(held.error().code, ErrorCode::refused);
  EXPECT_THAT(held.error().message, HasSubstr("answers that its output is off"));
}

TEST(ScpiGenerator, TakesTheClockOfAVirtualBench) {
  FakeGenerator instrument({}, "dyncal virtual bench,bma280,1,1");
  auto generator = ScpiGenerator::connect(instrument.address());
  ASSERT_TRUE(generator) << generator.error().message;
  EXPECT_EQ((*generator)->clock_now_s().value(), 12.5);
  EXPECT_EQ((*generator)->wait_until_s(1000.25, {}).value(), 1000.25);
}

TEST(ScpiGenerator, EndsItsWaitWhenAskedToStop) {
  FakeGenerator instrument;
  auto generator = ScpiGenerator::connect(instrument.address());
  ASSERT_TRUE(generator) << generator.error().message;
  std::stop_source stop;
  stop.request_stop();
  const auto end_s = (*generator)->wait_until_s(1e6, stop.get_token());
  ASSERT_TRUE(end_s);
  EXPECT_LT(*end_s, 5.0);
}

TEST(ScpiGenerator, DoesNotBelieveThatAnOutputIsOffWhichSaysThatItIsOn) {
  FakeGenerator instrument;
  auto generator = ScpiGenerator::connect(instrument.address());
  ASSERT_TRUE(generator) << generator.error().message;
  ASSERT_TRUE((*generator)->set_output(true));
  EXPECT_TRUE((*generator)->output_is_on().value().value());
  instrument.ignore_off();
  const auto off = (*generator)->set_output(false);
  ASSERT_FALSE(off);
  EXPECT_EQ(off.error().code, ErrorCode::refused);
  EXPECT_THAT(off.error().message, HasSubstr("OUTPUT IS STILL ON"));
  // Another program that connects to switch it off, as dyncal-guard does, is told as well.
  EXPECT_THAT(off.error().message, HasSubstr(instrument.address()));
}

TEST(ScpiGenerator, ConnectsOnlyWhereTheOutputIsOff) {
  FakeGenerator instrument;
  instrument.always_answer_output("1");
  const auto generator = ScpiGenerator::connect(instrument.address());
  ASSERT_FALSE(generator);
  EXPECT_THAT(generator.error().message, HasSubstr("OUTPUT IS STILL ON"));
}

TEST(ScpiGenerator, GoesOnWhereTheAnswerSaysNeither) {
  FakeGenerator instrument;
  instrument.always_answer_output("HIZ");
  auto generator = ScpiGenerator::connect(instrument.address());
  ASSERT_TRUE(generator) << generator.error().message;
  EXPECT_FALSE((*generator)->output_is_on().value().has_value());
  EXPECT_TRUE((*generator)->set_output(false));
}

// Else a sine of the peak of all lines would reach the exciter.
TEST(ScpiGenerator, SwitchesNothingOnOverAnotherConnectionThanThatOfItsWaveform) {
  FakeGenerator fake({}, "Rigol Technologies,DG952,DG9A,00.01.14");
  auto generator = ScpiGenerator::connect(fake.address());
  ASSERT_TRUE(generator) << generator.error().message;
  const std::vector<double> samples{1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0};
  ASSERT_TRUE((*generator)->set_waveform(samples, 10.0));
  fake.hang_up();
  EXPECT_FALSE((*generator)->set_output(true));
  ASSERT_TRUE((*generator)->set_frequency("40")); // connects anew
  const auto on = (*generator)->set_output(true);
  ASSERT_FALSE(on);
  EXPECT_EQ(on.error().code, ErrorCode::disconnected);
  EXPECT_THAT(on.error().message, HasSubstr("no longer has its waveform"));
  EXPECT_THAT(fake.commands(), testing::Not(testing::Contains(":OUTPut1 ON")));
  ASSERT_TRUE((*generator)->set_waveform(samples, 10.0));
  EXPECT_TRUE((*generator)->set_output(true));
}

TEST(ScpiGenerator, SaysThatNobodyListens) {
  std::string address;
  {
    const ScriptedInstrument gone([](int, ScriptedInstrument::Client&) {});
    address = gone.address();
  }
  const auto generator = ScpiGenerator::connect(address);
  ASSERT_FALSE(generator);
  EXPECT_EQ(generator.error().code, ErrorCode::refused);
  EXPECT_THAT(generator.error().message, HasSubstr(address));
}

// Half of the answer is there; the rest comes only after the caller was called.
TEST(ScpiGenerator, CallsWhileAnAnswerLetsWaitAndReadsItToItsEnd) {
  std::promise<void> called;
  const auto was_called = called.get_future().share();
  const ScriptedInstrument slow([was_called](int, ScriptedInstrument::Client& client) {
    for (std::string line = client.hear(); !line.empty(); line = client.hear()) {
      if (line == "*IDN?") {
        client.say("dyncal virtual bench,bma280,1,1\n");
      } else if (line == ":SYSTem:ERRor?") {
        client.say("0,\"No error\"\n");
      } else if (line.ends_with("?") && line != ":BENCh:TIME?") {
        client.say("OFF\n");
      } else if (line == ":BENCh:TIME?") {
        client.say("12");
        was_called.wait();
        client.say(".5\n");
      }
    }
  });
  auto generator = ScpiGenerator::connect(slow.address());
  ASSERT_TRUE(generator) << generator.error().message;
  int calls = 0;
  (*generator)->call_while_waiting([&](Awaited) {
    if (++calls == 1) {
      called.set_value();
    }
    return true;
  });
  EXPECT_EQ((*generator)->clock_now_s().value(), 12.5);
  EXPECT_GE(calls, 1);
}

// The virtual bench answers, and its time stands.
TEST(ScpiGenerator, SaysThatItIsTheBenchTimeWhichLetsWait) {
  const ScriptedInstrument standing([](int, ScriptedInstrument::Client& client) {
    for (std::string line = client.hear(); !line.empty(); line = client.hear()) {
      if (line == "*IDN?") {
        client.say("dyncal virtual bench,bma280,1,1\n");
      } else if (line == ":SYSTem:ERRor?") {
        client.say("0,\"No error\"\n");
      } else if (line.find('?') != std::string::npos) {
        client.say("0\n");
      }
    }
  });
  auto generator = ScpiGenerator::connect(standing.address());
  ASSERT_TRUE(generator) << generator.error().message;
  int calls = 0;
  (*generator)->call_while_waiting([&](Awaited awaited) {
    EXPECT_EQ(awaited, Awaited::bench_time);
    return ++calls < 3;
  });
  EXPECT_EQ((*generator)->wait_until_s(10.0, {}).value(), 0.0);
  EXPECT_EQ(calls, 3);
}

TEST(ScpiGenerator, GivesATimeUpThatNobodyNeedsAnyMore) {
  const ScriptedInstrument silent([](int, ScriptedInstrument::Client& client) {
    for (std::string line = client.hear(); !line.empty(); line = client.hear()) {
      if (line == "*IDN?") {
        client.say("dyncal virtual bench,bma280,1,1\n");
      } else if (line == ":SYSTem:ERRor?") {
        client.say("0,\"No error\"\n");
      } else if (line.ends_with("?") && line != ":BENCh:TIME?") {
        client.say("0\n");
      }
    }
  });
  auto generator = ScpiGenerator::connect(silent.address());
  ASSERT_TRUE(generator) << generator.error().message;
  int calls = 0;
  (*generator)->call_while_waiting([&](Awaited awaited) {
    EXPECT_EQ(awaited, Awaited::answer); // nobody has hold of an instrument that does not answer
    return ++calls < 2;
  });
  EXPECT_EQ((*generator)->clock_now_s().error().code, ErrorCode::timeout);
  EXPECT_EQ(calls, 2);
}

// A terminal is closed while the answer to ON lets wait; the output is switched off at once.
TEST(ScpiGenerator, WaitsForAnOffHoweverEndsTheRest) {
  std::atomic<int> offs{0};
  std::atomic<bool> is_mute{false};
  const ScriptedInstrument slow([&](int, ScriptedInstrument::Client& client) {
    for (std::string line = client.hear(); !line.empty(); line = client.hear()) {
      offs += line == ":OUTPut1 OFF" ? 1 : 0;
      is_mute = is_mute || line == ":OUTPut1 ON";
      if (line.find('?') != std::string::npos && !is_mute) {
        client.say(line == "*IDN?"            ? "Rigol Technologies,DG4162,1,2\n"
                   : line == ":SYSTem:ERRor?" ? "0,\"No error\"\n"
                                              : "0\n");
      }
    }
  });
  auto generator = ScpiGenerator::connect(slow.address());
  ASSERT_TRUE(generator) << generator.error().message;
  (*generator)->call_while_waiting([](Awaited) { return false; });
  EXPECT_EQ((*generator)->set_output(true).error().code, ErrorCode::timeout);
  const int before = offs;
  is_mute = false;
  EXPECT_TRUE((*generator)->set_output(false));
  EXPECT_GT(offs, before);
}

TEST(ScpiGenerator, SaysThatTheInstrumentDoesNotAnswer) {
  const ScriptedInstrument mute([](int, ScriptedInstrument::Client& client) {
    while (!client.hear().empty()) {
    }
  });
  const auto generator = ScpiGenerator::connect(mute.address());
  ASSERT_FALSE(generator);
  EXPECT_EQ(generator.error().code, ErrorCode::timeout);
  EXPECT_THAT(generator.error().message, HasSubstr("*IDN?"));
}

TEST(ScpiGenerator, RefusesAnAddressOrAmplitudeThatCannotBe) {
  EXPECT_EQ(ScpiGenerator::connect("nowhere").error().code, ErrorCode::malformed);
  FakeGenerator instrument;
  auto generator = ScpiGenerator::connect(instrument.address());
  ASSERT_TRUE(generator);
  EXPECT_EQ((*generator)->set_amplitude_v(-1.0).error().code, ErrorCode::invalid_setting);
}

} // namespace
} // namespace dyncal::drivers::generator
