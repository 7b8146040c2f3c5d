#include "drivers/generator/by_hand_generator.hpp"

#include <array>
#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <unistd.h>

#include "tests/patience.hpp"

namespace dyncal::drivers::generator {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ByHand : public ::testing::Test {
protected:
  ByHand() {
    EXPECT_EQ(pipe(pipe_.data()), 0);
    generator_ = std::make_unique<ByHandGenerator>(
        pipe_[0], [this](const std::string& text) { shown_.push_back(text); });
  }
  ~ByHand() override {
    generator_.reset();
    close(pipe_[0]);
    end_of_input();
  }
  void type(const std::string& text) const {
    EXPECT_EQ(write(pipe_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  void end_of_input() {
    if (pipe_[1] >= 0) {
      close(pipe_[1]);
    }
    pipe_[1] = -1;
  }
  void set(const std::string& frequency_hz, double amplitude_v) {
    EXPECT_TRUE(generator_->set_frequency(frequency_hz));
    EXPECT_TRUE(generator_->set_amplitude_v(amplitude_v));
    EXPECT_TRUE(generator_->set_output(true));
  }

  std::array<int, 2> pipe_{};
  std::vector<std::string> shown_;
  std::unique_ptr<ByHandGenerator> generator_;
};

TEST_F(ByHand, SaysWhatToSetAndWaitsForTheWord) {
  set("12.5", 0.2);
  ASSERT_EQ(shown_.size(), 1U);
  EXPECT_THAT(
      shown_[0],
      HasSubstr(
          "12.5 Hz, 0.2 V amplitude (0.4 V peak to peak); switch the output on, then press Enter"));
  EXPECT_FALSE(*generator_->wait_for_effect(milliseconds(1)));
  type("\n");
  EXPECT_TRUE(*generator_->wait_for_effect(tests::patience));
  EXPECT_TRUE(*generator_->wait_for_effect(milliseconds(0)));
}

TEST_F(ByHand, OneLineConfirmsOneRequest) {
  set("10", 0.1);
  type("done\n\n");
  EXPECT_TRUE(*generator_->wait_for_effect(tests::patience));
  EXPECT_TRUE(generator_->set_output(false));
  EXPECT_TRUE(*generator_->wait_for_effect(tests::patience));
  set("20", 0.1);
  EXPECT_FALSE(*generator_->wait_for_effect(milliseconds(1)));
}

TEST_F(ByHand, HalfALineIsNoConfirmationYet) {
  set("10", 0.1);
  type("do");
  EXPECT_FALSE(*generator_->wait_for_effect(milliseconds(1)));
  type("ne\n");
  EXPECT_TRUE(*generator_->wait_for_effect(tests::patience));
}

TEST_F(ByHand, TheEndOfTheInputIsAnError) {
  set("10", 0.1);
  end_of_input();
  const auto waited = generator_->wait_for_effect(tests::patience);
  ASSERT_FALSE(waited);
  EXPECT_EQ(waited.error().code, ErrorCode::disconnected);
}

TEST_F(ByHand, AsksForTheOutputToBeSwitchedOffWhenItGoesAway) {
  set("10", 0.1);
  generator_.reset();
  EXPECT_THAT(shown_.back(), HasSubstr("switch the generator's output off"));
}

TEST_F(ByHand, AsksOnceForTheOutputToBeSwitchedOffAndTakesOnlyAConfirmationForIt) {
  set("10", 0.1);
  type("\n");
  EXPECT_TRUE(*generator_->wait_for_effect(tests::patience));
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(generator_->set_output(false));
    EXPECT_FALSE(*generator_->wait_for_effect(milliseconds(0)));
  }
  EXPECT_EQ(shown_.size(), 2U);
  EXPECT_THAT(shown_.back(), HasSubstr("switch the output off, then press Enter"));
  type("\n");
  EXPECT_TRUE(*generator_->wait_for_effect(tests::patience));
  EXPECT_TRUE(generator_->set_output(false));
  EXPECT_TRUE(*generator_->wait_for_effect(milliseconds(0)));
  generator_.reset();
  EXPECT_EQ(shown_.size(), 2U);
}

TEST_F(ByHand, TheAnswerToAnEarlierQuestionDoesNotConfirmThatTheOutputIsOff) {
  set("10", 0.1);
  EXPECT_TRUE(generator_->set_output(false));
  type("\n"); // the output is on
  EXPECT_FALSE(*generator_->wait_for_effect(milliseconds(1)));
  type("\n");
  EXPECT_TRUE(*generator_->wait_for_effect(tests::patience));
}

TEST_F(ByHand, SaysNothingWhenTheOutputWasNeverOn) {
  EXPECT_TRUE(generator_->set_output(false));
  generator_.reset();
  EXPECT_TRUE(shown_.empty());
}

TEST_F(ByHand, ANewAmplitudeIsAskedForByItself) {
  set("10", 0.1);
  type("\n");
  EXPECT_TRUE(*generator_->wait_for_effect(tests::patience));
  EXPECT_TRUE(generator_->set_amplitude_v(0.11));
  EXPECT_THAT(shown_.back(), HasSubstr("set 0.11 V amplitude"));
  EXPECT_FALSE(*generator_->wait_for_effect(milliseconds(1)));
}

} // namespace
} // namespace dyncal::drivers::generator
