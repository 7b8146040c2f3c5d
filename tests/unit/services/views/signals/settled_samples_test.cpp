#include "services/views/signals/settled_samples.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "services/views/signals/sine_view.hpp"

namespace dyncal::inline views {
namespace {

using Instant = ChannelRing::Instant;

Instant at(double time_s) {
  return Instant(std::chrono::nanoseconds(std::llround(1e9 * (1000.0 + time_s))));
}

struct Step {
  std::string frequency_hz;
  double frequency = 0.0;
  double amplitude = 0.0; // 0: nothing is excited
  double on_s = 0.0;      // times of the output
  double steady_s = 0.0;
  double off_s = 0.0;
};

// A run as a visitor of the page sees it: a source that sends blocks, later than they are taken,
// and announcements that are heard somewhat later than they are made.
struct Scene {
  std::vector<Step> steps;
  double rate_hz = 1000.0;
  double clock_rel = 0.0;   // by which its clock is fast
  double lag_s = 0.02;      // until samples are here
  double heard_s = 0.005;   // until an announcement is
  double noise_rel = 1e-3;  // of the amplitude
  double builds_up_s = 0.1; // time constant
  double opened_s = 0.0;    // when the ring begins
  double block_s = 0.02;

  [[nodiscard]] double end_s() const { return steps.back().off_s + 1.0; }

  [[nodiscard]] double value(double time_s, std::mt19937& random) const {
    std::normal_distribution<double> noise;
    double value = noise_rel * noise(random);
    double ringing = 0.0;
    for (const Step& step : steps) {
      const double turns = step.frequency * time_s;
      const double sine = std::sin(2.0 * std::numbers::pi * (turns - std::floor(turns)));
      if (time_s >= step.on_s && time_s < step.off_s) {
        return value +
               step.amplitude * sine * (1.0 - std::exp(-(time_s - step.on_s) / builds_up_s)) +
               ringing;
      }
      ringing = time_s < step.off_s
                    ? ringing
                    : step.amplitude * sine * std::exp(-(time_s - step.off_s) / 0.03);
    }
    return value + ringing;
  }
};

struct Answers {
  int right = 0;
  int wrong = 0;
  int settling = 0;
  std::vector<int> of_step; // numbers given of each
  std::string first_wrong;
};

void look(const Scene& scene, const ChannelRing& ring, double now_s, Answers& answers) {
  for (std::size_t i = 0; i < scene.steps.size(); ++i) {
    const Step& step = scene.steps[i];
    const double announced_s = step.on_s - 0.02 + scene.heard_s;
    const double steady_s = step.steady_s + scene.heard_s;
    if (now_s < steady_s || now_s >= step.off_s + 0.05 + scene.heard_s) {
      continue;
    }
    const auto window = step_window(ring, at(announced_s), at(steady_s), false);
    const auto samples = window ? samples_around(ring, *window) : std::vector<Sample>{};
    const auto settled =
        window ? find_settled(samples, *window, *analysis::Frequency::parse(step.frequency_hz))
               : std::nullopt;
    const auto view = settled ? view_sine(*settled, 100) : fail(ErrorCode::no_source, "settling");
    if (!view) {
      ++answers.settling;
      continue;
    }
    ++answers.of_step[i];
    const double error = view->fit.amplitude() - step.amplitude;
    const bool is_right = std::abs(error) <= 0.006 * step.amplitude + 5.0 * view->fit.u_amplitude();
    ++(is_right ? answers.right : answers.wrong);
    if (!is_right && answers.first_wrong.empty()) {
      answers.first_wrong =
          fmt::format("step {}, {} Hz, {} s after it was steady: {} (u {}) where {} is true", i,
                      step.frequency_hz, now_s - step.steady_s, view->fit.amplitude(),
                      view->fit.u_amplitude(), step.amplitude);
    }
  }
}

// Every quarter of a second.
Answers visit(const Scene& scene, unsigned seed) {
  std::mt19937 random(seed);
  ChannelRing ring;
  Answers answers;
  answers.of_step.resize(scene.steps.size());
  const auto block = static_cast<std::int64_t>(std::max(1.0, scene.block_s * scene.rate_hz));
  double look_s = 0.13;
  for (std::int64_t first = 0; look_s < scene.end_s(); first += block) {
    std::vector<std::int64_t> stamps_ns;
    std::vector<double> values;
    double time_s = 0.0;
    for (std::int64_t i = first; i < first + block; ++i) {
      time_s = static_cast<double>(i) / scene.rate_hz;
      stamps_ns.push_back(std::llround(1e9 * time_s * (1.0 + scene.clock_rel)) + 5'000'000'000);
      values.push_back(scene.value(time_s, random));
    }
    const double came_s = time_s + scene.lag_s;
    for (; look_s < came_s; look_s += 0.25) {
      look(scene, ring, look_s, answers);
    }
    if (came_s >= scene.opened_s) {
      ring.push(stamps_ns, values, false, 0, at(came_s));
    }
  }
  return answers;
}

double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

// Steps one after the other, some of the frequency and level of the one before.
std::vector<Step> drawn_steps(std::mt19937& random) {
  const std::vector<std::string> frequencies{"5", "12.5", "16", "40", "50", "80", "160", "200"};
  std::vector<Step> steps;
  double time_s = uniform(random, 0.2, 1.5);
  for (int i = 0; i < 6; ++i) {
    Step step;
    const bool again = i > 0 && random() % 3 == 0;
    step.frequency_hz =
        again ? steps.back().frequency_hz : frequencies[random() % frequencies.size()];
    step.frequency = std::stod(step.frequency_hz);
    step.amplitude = again && random() % 2 == 0 ? steps.back().amplitude : uniform(random, 1, 20);
    step.on_s = time_s;
    step.steady_s = time_s + uniform(random, 0.5, 1.2);
    step.off_s = step.steady_s + uniform(random, 1.5, 3.5);
    time_s = step.off_s + uniform(random, 0.35, 1.0);
    steps.push_back(step);
  }
  return steps;
}

Scene drawn_scene(unsigned seed) {
  std::mt19937 random(seed);
  Scene scene;
  scene.steps = drawn_steps(random);
  scene.rate_hz = random() % 3 == 0 ? 10'000.0 : 1003.1;
  scene.clock_rel = uniform(random, -3e-4, 3e-4);
  scene.lag_s = random() % 3 == 0 ? uniform(random, 0.1, 1.8) : uniform(random, 0.01, 0.1);
  scene.heard_s = uniform(random, 0.0, 0.2);
  scene.noise_rel = random() % 2 == 0 ? 1e-3 : 0.05;
  scene.builds_up_s = uniform(random, 0.01, 0.25);
  scene.opened_s = random() % 4 == 0 ? uniform(random, 0.0, 8.0) : 0.0;
  return scene;
}

TEST(SettledSamples, NoAnswerIsWrongAndMostStepsAreSeen) {
  int answers = 0;
  int seen = 0;
  int steps = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const Scene scene = drawn_scene(seed);
    const Answers got = visit(scene, seed);
    EXPECT_EQ(got.wrong, 0) << "seed " << seed << ": " << got.first_wrong;
    answers += got.right + got.settling;
    if (scene.lag_s < 0.2 && scene.opened_s == 0.0) {
      seen += static_cast<int>(std::ranges::count_if(got.of_step, [](int n) { return n > 0; }));
      steps += static_cast<int>(got.of_step.size());
    }
  }
  EXPECT_GT(answers, 2000);
  EXPECT_GT(seen, 0.95 * steps) << steps;
}

// 63 of 63 answers were wrong: the newest samples, steps before included.
TEST(SettledSamples, TheStepBeforeDoesNotCount) {
  Scene scene;
  scene.steps = {{"40", 40.0, 20.0, 0.5, 1.5, 2.7}, {"80", 80.0, 10.0, 3.1, 4.1, 5.4}};
  const Answers got = visit(scene, 7);
  EXPECT_EQ(got.wrong, 0) << got.first_wrong;
  EXPECT_GE(got.of_step[0], 3);
  EXPECT_GE(got.of_step[1], 3);
}

TEST(SettledSamples, TheSameStepBeforeOfASourceThatLags) {
  Scene scene;
  scene.lag_s = 1.7; // longer than the pause and the settling
  scene.steps = {{"40", 40.0, 20.0, 0.5, 1.5, 5.0}, {"40", 40.0, 10.0, 5.4, 6.0, 10.0}};
  const Answers got = visit(scene, 7);
  EXPECT_EQ(got.wrong, 0) << got.first_wrong;
  EXPECT_GT(got.of_step[1], 0);
}

TEST(SettledSamples, WhatIsNotSettledYetHasNoNumber) {
  Scene scene;
  scene.builds_up_s = 2.0; // as if settling_s were far too short
  scene.steps = {{"40", 40.0, 20.0, 0.5, 0.7, 4.0}};
  const Answers got = visit(scene, 7);
  EXPECT_EQ(got.right + got.wrong, 0);
  EXPECT_GT(got.settling, 5);
}

TEST(SettledSamples, WithoutExcitationThereIsNone) {
  Scene scene;
  scene.noise_rel = 1.0;
  scene.steps = {{"40", 40.0, 0.0, 0.5, 1.5, 6.0}};
  const Answers got = visit(scene, 7);
  EXPECT_EQ(got.right + got.wrong, 0);
}

TEST(SettledSamples, AFrequencyThatIsOffByTheClockDoesNotShrinkTheAmplitude) {
  Scene scene;
  scene.clock_rel = 5e-4; // over 4 s of 200 Hz 0.4 periods: 25 % of the amplitude
  scene.rate_hz = 2000.0;
  scene.steps = {{"200", 200.0, 10.0, 0.5, 1.0, 9.0}};
  const Answers got = visit(scene, 7);
  EXPECT_EQ(got.wrong, 0) << got.first_wrong;
  EXPECT_GT(got.right, 20);
}

TEST(SettledSamples, ATriggeredRecordIsOfTheStepItCameIn) {
  ChannelRing ring;
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  for (std::int64_t i = 0; i < 1000; ++i) {
    stamps_ns.push_back(i * 50'000);
    values.push_back(2.0 * std::sin(2.0 * std::numbers::pi * 40.0 * 5e-5 * static_cast<double>(i)));
  }
  ring.push(stamps_ns, values, false, 0, at(3.0));
  const auto frequency = *analysis::Frequency::parse("40");
  EXPECT_FALSE(step_window(ring, at(2.0), at(3.1), true)) << "of the step before";
  const auto window = step_window(ring, at(2.0), at(2.9), true);
  ASSERT_TRUE(window);
  const auto samples = samples_around(ring, *window);
  const auto settled = find_settled(samples, *window, frequency);
  ASSERT_TRUE(settled);
  EXPECT_NEAR(view_sine(*settled, 100)->fit.amplitude(), 2.0, 1e-6);
}

} // namespace
} // namespace dyncal::inline views
