// The bus and programs that know the contract from its IDL file and its page alone, one made with
// each vendor's own tools. They write back what they read, so that equal samples show both ways to
// work.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "services/bus/bus.hpp"
#include "services/contract/topics.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"

namespace dyncal::bus {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct Native {
  std::string name;
  std::string program;
  std::string setting; // environment variable with the vendor's profile of idl/profiles/
};

std::vector<Native> natives() {
  std::vector<Native> programs;
#ifdef DYNCAL_NATIVE_FAST_PEER
  programs.push_back({"fastddsgen", DYNCAL_NATIVE_FAST_PEER,
                      DYNCAL_FAST_DDS_SETTING "=" DYNCAL_PROFILES "/fast_dds.xml"});
#endif
#ifdef DYNCAL_NATIVE_CYCLONE_PEER
  programs.push_back({"idlc", DYNCAL_NATIVE_CYCLONE_PEER,
                      "CYCLONEDDS_URI=file://" DYNCAL_PROFILES "/cyclone_dds.xml"});
#endif
  return programs;
}

// Runs as long as this lives, and no longer than the test.
class Process {
public:
  Process(const Native& native, const std::vector<std::string>& arguments) {
    std::vector<std::string> words{native.program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) {
      argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    std::string setting = native.setting;
    std::vector<char*> environment{setting.data()};
    for (char** inherited = environ; *inherited != nullptr; ++inherited) {
      environment.push_back(*inherited);
    }
    environment.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) {
      return;
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    execve(argv[0], argv.data(), environment.data());
    _exit(127);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process() {
    if (!started()) {
      return;
    }
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  [[nodiscard]] bool started() const { return pid_ > 0; }

private:
  pid_t pid_ = 0;
};

class BusNative : public testing::TestWithParam<std::tuple<Native, Vendor>> {
protected:
  const int domain_ = tests::own_dds_domain();
  const std::string to_native_ = "to-native";
  const std::string from_native_ = "from-native";
  const Process process_{std::get<0>(GetParam()),
                         {std::to_string(domain_), to_native_, from_native_}};
  Participant participant_ = join();
  std::shared_ptr<WakeUp> bell_ = std::make_shared<WakeUp>();

  [[nodiscard]] Participant join() const {
    ParticipantOptions options;
    options.vendor = std::get<1>(GetParam());
    options.domain = domain_;
    options.name = "native test";
    options.watch_discovery = true;
    return Participant::create(options).value();
  }

  void SetUp() override { ASSERT_TRUE(process_.started()); }

  template <class T>
  std::vector<T> echoes_of(const std::vector<T>& samples, const char* topic, Profile profile) {
    auto reader = participant_.reader<T>(topic, profile, from_native_ + "*", bell_).value();
    auto writer = participant_.writer<T>(topic, profile, to_native_).value();
    for (const T& sample : samples) {
      EXPECT_EQ(writer.write(sample), WriteOutcome::written);
    }
    std::vector<T> echoes;
    const auto give_up = Clock::now() + tests::patience;
    while (echoes.size() < samples.size() && Clock::now() < give_up) {
      bell_->wait_until(Clock::now() + 50ms);
      reader.take([&](const T& sample) { echoes.push_back(sample); });
    }
    return echoes;
  }
};

wire::SineFit example_fit(const std::string& channel) {
  wire::SineFit fit;
  fit.channel(channel);
  fit.frequency_hz(10.0 + 1e-9);
  fit.phase_origin_ns(1'500'000'000'123'456'789);
  fit.sine(0.1);
  fit.cosine(-0.2);
  fit.sample_count(3010);
  return fit;
}

// In one line, which can be read where two differ.
std::string numbers_of(const std::vector<wire::SampleBlock>& blocks) {
  std::string numbers;
  for (const wire::SampleBlock& block : blocks) {
    numbers += block.source().c_str()[0] + std::to_string(block.block()) + " ";
  }
  return numbers;
}

TEST_P(BusNative, ExchangesSampleBlocks) {
  std::vector<wire::SampleBlock> blocks;
  for (const std::string& source : {std::string("a"), std::string(64, 'z')}) {
    for (std::uint64_t number = 0; number < 50; ++number) {
      wire::SampleBlock block;
      block.bench("acc-1");
      block.source(source);
      block.session(0xfedcba9876543210U);
      block.block(number);
      block.first_sample(number * 3);
      block.sample_count(3);
      block.channel_count(2);
      block.acknowledged_run(number == 0 ? "" : "run-" + std::to_string(number));
      block.end_of_stream(number == 49);
      block.origin_ns(-1);
      block.interval_numerator_ns(1'000'000);
      block.interval_denominator(3);
      block.stamps_ns({1, 2, 3});
      block.stamp_uncertainty_ns({4, 5, 0xffffffffU});
      block.stamp_flags({0, 1, 128});
      block.values(
          std::vector<double>(number == 7 ? 10'000 : 6, 0.1 * static_cast<double>(number)));
      block.received_utc_ns(1'700'000'000'000'000'000);
      blocks.push_back(block);
    }
  }
  const auto echoes = echoes_of(blocks, topics::dau_samples, Profile::samples);
  EXPECT_EQ(numbers_of(echoes), numbers_of(blocks));
  EXPECT_EQ(echoes, blocks);
}

TEST_P(BusNative, ExchangesMeasurements) {
  wire::Measurement measurement;
  measurement.bench("acc-1");
  measurement.run(std::string(64, 'r'));
  measurement.state(wire::MEASUREMENT_RUNNING);
  measurement.method(wire::METHOD_SAMPLE_TIMESTAMPING);
  measurement.reference("acs/reference");
  measurement.dut({"dau/acceleration_x", "dau/acceleration_z"});
  for (std::uint32_t step = 0; step < 51; ++step) {
    wire::PlannedStep planned;
    planned.step(step);
    planned.frequency_text_hz("12.5");
    planned.level_m_s2(10.0);
    planned.repetition(step % 3 + 1);
    measurement.steps().push_back(planned);
  }
  wire::AdcCalibrationPoint point;
  point.gain(0.998);
  measurement.adc_calibration({point});
  measurement.recipe(std::string(3000, '#'));
  measurement.message("a sentence");
  EXPECT_EQ(echoes_of<wire::Measurement>({measurement}, topics::measurement, Profile::state),
            std::vector<wire::Measurement>{measurement});
}

TEST_P(BusNative, ExchangesCalibrationResults) {
  std::vector<wire::CalibrationResult> results;
  for (std::uint32_t step = 0; step < 20; ++step) {
    wire::CalibrationResult result;
    result.bench("acc-1");
    result.run("run-1");
    result.channel("dau/acceleration_z");
    result.step(step);
    result.repetition(step + 1);
    result.frequency_text_hz("199.87");
    result.valid(true);
    result.magnitude(1.0);
    result.phase_rad(-0.5);
    result.fits({example_fit("acs/reference"), example_fit("dau/acceleration_z")});
    wire::BudgetContribution contribution;
    contribution.kind(wire::CONTRIBUTION_SHOTS);
    contribution.name("reference");
    contribution.repeats(wire::REPEATS_ANEW);
    contribution.degrees_of_freedom(std::numeric_limits<double>::infinity());
    contribution.u_magnitude_rel(1e-3);
    result.budget({contribution});
    wire::SourceSamples samples;
    samples.source("dau");
    samples.used(3010);
    result.samples({samples});
    result.flags({"one", "two"});
    results.push_back(result);
  }
  auto echoes = echoes_of(results, topics::calibration_result, Profile::results);
  std::sort(echoes.begin(), echoes.end(),
            [](const auto& a, const auto& b) { return a.step() < b.step(); });
  EXPECT_EQ(echoes, results);
}

TEST_P(BusNative, TellsTheQosOfItsReaders) {
  const auto reader_of = [this](const std::string& topic) -> std::optional<DiscoveredEndpoint> {
    const auto give_up = Clock::now() + tests::patience;
    while (Clock::now() < give_up) {
      for (const DiscoveredEndpoint& endpoint : participant_.discovered().endpoints) {
        if (endpoint.topic == topic && endpoint.kind == EndpointKind::reader) {
          return endpoint;
        }
      }
      bell_->wait_until(Clock::now() + 50ms);
    }
    return std::nullopt;
  };
  const auto more = reader_of(topics::excitation);
  ASSERT_TRUE(more);
  EXPECT_TRUE(more->exclusive_ownership);
  EXPECT_DOUBLE_EQ(more->deadline_s, 1.0);
  EXPECT_EQ(more->liveliness, Liveliness::manual_by_topic);
  EXPECT_DOUBLE_EQ(more->lease_s, 2.0);
  const auto usual = reader_of(topics::dau_samples);
  ASSERT_TRUE(usual);
  EXPECT_FALSE(usual->exclusive_ownership);
  EXPECT_TRUE(std::isinf(usual->deadline_s));
  EXPECT_EQ(usual->latency_budget_s, 0.0);
  EXPECT_EQ(usual->liveliness, Liveliness::automatic);
  EXPECT_TRUE(std::isinf(usual->lease_s));
  EXPECT_EQ(usual->access_scope, AccessScope::instance);
  EXPECT_FALSE(usual->coherent_access || usual->ordered_access);
  EXPECT_EQ(usual->destination_order, DestinationOrder::by_reception);
  constexpr int xcdr1 = 0;
  const std::vector<int>& taken = usual->representations;
  EXPECT_TRUE(taken.empty() || std::ranges::find(taken, xcdr1) != taken.end());
}

// As a later version of the contract could have it. idl/README.md tells what each tool makes of it.
TEST_P(BusNative, GoesOnAfterAnEnumValueOfALaterVersion) {
  auto reader =
      participant_
          .reader<wire::Measurement>(topics::measurement, Profile::state, from_native_ + "*", bell_)
          .value();
  auto writer =
      participant_.writer<wire::Measurement>(topics::measurement, Profile::state, to_native_)
          .value();
  wire::Measurement later;
  later.bench("acc-1");
  later.run("later");
  later.method(static_cast<wire::Method>(99));
  wire::Measurement last;
  last.bench("acc-1");
  last.run("last");
  ASSERT_EQ(writer.write(later), WriteOutcome::written);
  ASSERT_EQ(writer.write(last), WriteOutcome::written);
  std::map<std::string, wire::Method> echoes;
  const auto give_up = Clock::now() + tests::patience;
  while (!echoes.contains("last") && Clock::now() < give_up) {
    bell_->wait_until(Clock::now() + 50ms);
    reader.take(
        [&](const wire::Measurement& echo) { echoes[echo.run().to_string()] = echo.method(); });
  }
  EXPECT_TRUE(echoes.contains("last"));
  if (std::get<0>(GetParam()).name == "idlc") {
    EXPECT_FALSE(echoes.contains("later"));
  } else {
    ASSERT_TRUE(echoes.contains("later"));
    EXPECT_EQ(echoes["later"], static_cast<wire::Method>(99));
  }
}

INSTANTIATE_TEST_SUITE_P(EveryTool, BusNative,
                         testing::Combine(testing::ValuesIn(natives()),
                                          testing::ValuesIn(vendors_in_this_build())),
                         [](const auto& parameters) {
                           return std::get<0>(parameters.param).name + "_with_" +
                                  to_string(std::get<1>(parameters.param));
                         });

} // namespace
} // namespace dyncal::bus
