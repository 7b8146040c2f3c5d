// What other programs can do to the output that a guard watches over: nothing, by draws of what
// they repeat and invent, while the run is attended, when its conductor is cut off, over a restart
// of the guard, and where a run is resumed or has a conductor of contract 2.
#include <random>
#include <vector>

#include "tests/unit/services/programs/guard/guarded_bench.hpp"
#include "tests/unit/services/programs/guard/played_conductor.hpp"

namespace dyncal::inline programs::guard_tests {
namespace {

constexpr int draws = 20;

// A program that writes on the bench.
class Program {
public:
  explicit Program(bus::Participant participant)
      : participant_(std::move(participant)),
        measurement_(participant_.writer(bus::topics::measurement, "b1").value()),
        excitation_(participant_.writer(bus::topics::excitation, "b1").value()) {}

  void say(const wire::Measurement& message) { measurement_.write(message); }
  void say(const wire::Excitation& message) { excitation_.write(message); }

private:
  bus::Participant participant_;
  bus::Writer<wire::Measurement> measurement_;
  bus::Writer<wire::Excitation> excitation_;
};

wire::Measurement without_links(wire::Measurement message) {
  message.excitation_anchor("");
  message.link("");
  message.link_number(0);
  return message;
}
wire::Excitation without_links(wire::Excitation message) {
  message.link("");
  message.link_number(0);
  return message;
}

class GuardedRunTest : public GuardedBench {
protected:
  PlayedConductor played_;
  std::unique_ptr<Program> program_ = std::make_unique<Program>(network_.join("conductor"));
  Program forger_{network_.join("forger")};
  PlayedConductor forged_;
  PlayedConductor forged_run_{"r9"};
  std::vector<wire::Excitation> seen_;
  std::vector<wire::Measurement> plans_;
  bool has_links_ = true;

  void restart_guard() {
    guard_.reset();
    guard_ = start();
  }
  void measure(wire::MeasurementState state = wire::MEASUREMENT_RUNNING) {
    auto message = played_.measurement(state);
    plans_.push_back(has_links_ ? message : without_links(message));
    program_->say(plans_.back());
    guard_->work();
  }
  void excite(wire::ExcitationState state = wire::EXCITATION_STEADY) {
    auto message = played_.excitation(state);
    seen_.push_back(has_links_ ? message : without_links(message));
    output_.is_on = state != wire::EXCITATION_DONE;
    program_->say(seen_.back());
    guard_->work();
  }
  // Half a second.
  void attend(wire::ExcitationState state = wire::EXCITATION_STEADY) {
    excite(state);
    pass(500ms);
  }
  void begin_run() {
    measure(wire::MEASUREMENT_PLANNED);
    pass(500ms);
    measure();
    excite(wire::EXCITATION_SETTLING);
    pass(500ms);
  }

  // One of everything that is known or can be made.
  void forge(std::mt19937_64& random) {
    constexpr int kinds = 10;
    const auto& replayed = seen_[random() % seen_.size()];
    switch (random() % kinds) {
    case 0:
      return forger_.say(replayed);
    case 1:
      return forger_.say(seen_.back());
    case 2:
      return forger_.say(plans_[random() % plans_.size()]);
    case 3:
      return forger_.say(forged_.excitation());
    case 4:
      return forger_.say(forged_.excitation(wire::EXCITATION_DONE));
    case 5:
      return forger_.say(forged_.measurement(wire::MEASUREMENT_ABORTED));
    case 6:
      return forger_.say(forged_run_.measurement());
    case 7:
      return forger_.say(forged_run_.excitation());
    case 8:
      return forger_.say(without_links(forged_.excitation()));
    default:
      return forger_.say(without_links(forged_run_.measurement(wire::MEASUREMENT_PLANNED)));
    }
  }
  void forge_for(std::chrono::milliseconds time, std::mt19937_64& random) {
    for (; time > 0ms; time -= 100ms) {
      forge(random);
      pass(100ms);
    }
  }
};

TEST_F(GuardedRunTest, NobodyElseHoldsTheOutputOnOfAConductorThatIsCutOff) {
  for (int seed = 1; seed <= draws; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    played_ = PlayedConductor("r" + std::to_string(seed));
    begin_run();
    const int before = tries_;
    for (std::uint64_t i = random() % 10; i > 0; --i) {
      attend();
    }
    excite();
    forge_for(2000ms, random);
    EXPECT_EQ(tries_, before) << seed;
    forge_for(200ms, random);
    EXPECT_FALSE(output_.is_on) << seed;
    forge_for(10s, random);
    EXPECT_FALSE(output_.is_on) << seed;
    pass(130s);
  }
}

TEST_F(GuardedRunTest, NobodyElseSwitchesTheOutputOffOfARunThatIsAttended) {
  for (int seed = 1; seed <= draws; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    played_ = PlayedConductor("r" + std::to_string(seed));
    begin_run();
    for (int i = 0; i < 40; ++i) {
      excite();
      forge_for(500ms, random);
      if (i % 4 == 0) {
        measure();
      }
      EXPECT_TRUE(output_.is_on) << seed << ": " << i;
      EXPECT_NE(newest_status().run().to_string(), plans_.back().run().to_string());
    }
    excite(wire::EXCITATION_DONE);
    measure(wire::MEASUREMENT_DONE);
    pass(1s);
    EXPECT_EQ(tries_, 0);
    pass(130s);
  }
}

// Its output is on at the settings of a step, and the run is said to be over.
TEST_F(GuardedRunTest, NobodyElseEndsTheWatchBetweenTwoSteps) {
  begin_run();
  excite(wire::EXCITATION_DONE);
  forger_.say(forged_.measurement(wire::MEASUREMENT_DONE));
  forger_.say(plans_.front());
  forger_.say(forged_run_.measurement());
  pass(500ms);
  output_.is_on = true; // its conductor is cut off just now
  pass(5s);
  EXPECT_FALSE(output_.is_on);
}

TEST_F(GuardedRunTest, AGuardThatRestartsGoesOnWithTheConductorAlone) {
  for (int seed = 1; seed <= draws; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    played_ = PlayedConductor("r" + std::to_string(seed));
    begin_run();
    const int before = tries_;
    for (int i = 0; i < 20; ++i) {
      attend();
    }
    restart_guard();
    for (int i = 0; i < 20; ++i) {
      excite();
      forge_for(500ms, random);
      EXPECT_TRUE(output_.is_on) << seed;
    }
    EXPECT_EQ(tries_, before);
    restart_guard(); // and the conductor is cut off meanwhile
    program_ = std::make_unique<Program>(network_.join("conductor"));
    forge_for(2200ms, random);
    EXPECT_FALSE(output_.is_on) << seed;
    EXPECT_EQ(tries_, before + 1);
    pass(130s);
  }
}

TEST_F(GuardedRunTest, GoesOnWithTheConductorThatResumesTheRun) {
  begin_run();
  attend();
  pass(3s); // it has died
  EXPECT_FALSE(output_.is_on);
  EXPECT_EQ(newest_status().run().to_string(), "r1");
  program_ = std::make_unique<Program>(network_.join("resumed"));
  played_ = PlayedConductor();
  excite(wire::EXCITATION_DONE); // may come before its Measurement
  measure();
  pass(100ms);
  EXPECT_EQ(newest_status().run().to_string(), "");
  for (int i = 0; i < 20; ++i) {
    attend();
  }
  EXPECT_TRUE(output_.is_on);
  EXPECT_EQ(tries_, 1);
  pass(2s);
  EXPECT_FALSE(output_.is_on);
}

TEST_F(GuardedRunTest, TakesTheNextRunAsSoonAsOneIsOver) {
  for (const std::string run : {"r1", "r2", "r3"}) {
    program_ = std::make_unique<Program>(network_.join("conductor"));
    played_ = PlayedConductor(run);
    begin_run();
    attend();
    excite(wire::EXCITATION_DONE);
    measure(wire::MEASUREMENT_DONE);
    pass(100ms);
    EXPECT_EQ(newest_status().run().to_string(), "");
  }
  EXPECT_EQ(tries_, 0);
}

TEST_F(GuardedRunTest, NamesARunThatDrivesBesideTheConductors) {
  begin_run();
  forger_.say(forged_run_.measurement(wire::MEASUREMENT_PLANNED));
  attend();
  EXPECT_EQ(newest_status().run().to_string(), "") << "it waits for the bench";
  forger_.say(forged_run_.measurement());
  attend();
  EXPECT_EQ(newest_status().run().to_string(), "r9");
  for (int i = 0; i < 6; ++i) {
    attend();
  }
  EXPECT_EQ(newest_status().run().to_string(), "");
  EXPECT_EQ(tries_, 0);
}

// Of contract 2.
TEST_F(GuardedRunTest, AConductorWithoutLinksIsToldByItsParticipant) {
  has_links_ = false;
  std::mt19937_64 random(1);
  begin_run();
  for (int i = 0; i < 40; ++i) {
    excite();
    forge_for(500ms, random);
    EXPECT_TRUE(output_.is_on) << i;
  }
  EXPECT_EQ(tries_, 0);
  forge_for(2s, random);
  EXPECT_FALSE(output_.is_on);
}

TEST_F(GuardedRunTest, ARunWithoutLinksDoesNotDisplaceOneThatLives) {
  begin_run();
  Program older(network_.join("older"));
  for (int i = 0; i < 20; ++i) {
    older.say(without_links(forged_run_.measurement()));
    older.say(without_links(forged_run_.excitation()));
    attend();
  }
  EXPECT_EQ(newest_status().run().to_string(), "r9") << "its conductor pauses";
  pass(2s);
  EXPECT_FALSE(output_.is_on) << "of the one that had links";
}

} // namespace
} // namespace dyncal::inline programs::guard_tests
