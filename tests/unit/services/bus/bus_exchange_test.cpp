#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <thread>

#include "services/bus/qos_profiles.hpp"
#include "services/bus/vendor.hpp"
#include "services/contract/topics.hpp"
#include "tests/unit/services/bus/bus_pair.hpp"

namespace dyncal::bus {
namespace {

using namespace std::chrono_literals;

class BusExchange : public BusPair {
protected:
  wire::SampleBlock block(std::uint64_t number, const std::string& source = "dau",
                          std::size_t values = 16) const {
    wire::SampleBlock block;
    block.bench(bench_);
    block.source(source);
    block.session(1);
    block.block(number);
    block.values().assign(values, static_cast<double>(number));
    return block;
  }

  static wire::Command command(const std::string& target, std::uint32_t run) {
    wire::Command command;
    command.target(target);
    command.run(std::to_string(run));
    return command;
  }
};

INSTANTIATE_TEST_SUITE_P(AllBuses, BusExchange, testing::ValuesIn(carrier_pairs()), pair_name);

// As of a program of another laboratory that writes in partition "*".
TEST_P(BusExchange, PassesOverMessagesThatNameAnotherBench) {
  auto writer = this->writer<wire::Command>(topics::command, Profile::state);
  auto reader = this->reader<wire::Command>(topics::command, Profile::state);
  wire::Command command;
  command.bench("another");
  ASSERT_EQ(writer.write(command), WriteOutcome::written);
  command.bench(bench_);
  ASSERT_EQ(writer.write(command), WriteOutcome::written);
  std::vector<std::string> benches;
  ASSERT_TRUE(wait_for([&] {
    return reader.take([&](const wire::Command& message) {
      benches.push_back(message.bench().to_string());
    }) > 0;
  }));
  EXPECT_EQ(benches, std::vector<std::string>{bench_});
}

// Of any length: one vendor reads four bytes at a time.
TEST_P(BusExchange, CarriesTheBytesThatWereEncodedAndNoOthers) {
  auto writer = this->writer<wire::SampleBlock>(topics::dau_samples, Profile::samples);
  auto reader = this->reader<wire::SampleBlock>(topics::dau_samples, Profile::samples);
  std::vector<std::string> sent;
  for (std::size_t values = 0; values < 1000; values = 3 * values + 1) {
    const EncodedMessage message = encode(block(sent.size(), "dau", values));
    ASSERT_EQ(writer.write_encoded(message, std::chrono::seconds(10)), WriteOutcome::written);
    sent.push_back(*message);
  }
  std::vector<std::string> came;
  ASSERT_TRUE(wait_for([&] {
    reader.take_with_bytes([&](const wire::SampleBlock& block, std::string_view bytes) {
      EXPECT_TRUE(is_whole(type_support<wire::SampleBlock>(), &block, bytes));
      came.emplace_back(bytes);
    });
    return came.size() >= sent.size();
  }));
  EXPECT_EQ(came, sent);
}

TEST_P(BusExchange, CarriesEveryBlockWholeAndInOrder) {
  auto writer = this->writer<wire::SampleBlock>(topics::dau_samples, Profile::samples);
  auto reader = this->reader<wire::SampleBlock>(topics::dau_samples, Profile::samples);
  constexpr std::uint64_t blocks = 500;
  constexpr std::size_t values = 5000; // 40 kB
  std::vector<std::uint64_t> numbers;
  const auto take = [&] {
    reader.take([&](const wire::SampleBlock& block) {
      EXPECT_EQ(block, this->block(block.block(), "dau", values));
      numbers.push_back(block.block());
    });
    return numbers.size() >= blocks;
  };
  for (std::uint64_t i = 0; i < blocks; ++i) {
    ASSERT_EQ(writer.write(block(i, "dau", values)), WriteOutcome::written);
    take();
  }
  ASSERT_TRUE(wait_for(take)) << numbers.size();
  for (std::uint64_t i = 0; i < blocks; ++i) {
    EXPECT_EQ(numbers[i], i);
  }
  EXPECT_TRUE(writer.wait_for_acknowledgments(tests::patience));
}

TEST_P(BusExchange, GivesALateJoinerTheMostRecentBlocksAndHoldsNoMore) {
  auto writer = this->writer<wire::SampleBlock>(topics::dau_samples, Profile::samples);
  const std::uint64_t blocks = late_joiner_blocks + 200;
  for (std::uint64_t i = 0; i < blocks; ++i) {
    ASSERT_EQ(writer.write(block(i)), WriteOutcome::written);
  }
  auto reader = this->reader<wire::SampleBlock>(topics::dau_samples, Profile::samples);
  std::vector<std::uint64_t> numbers;
  ASSERT_TRUE(wait_for([&] {
    reader.take([&](const wire::SampleBlock& block) { numbers.push_back(block.block()); });
    return !numbers.empty() && numbers.back() == blocks - 1;
  })) << numbers.size();
  ASSERT_EQ(numbers.size(), static_cast<std::size_t>(late_joiner_blocks));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    EXPECT_EQ(numbers[i], 200 + i);
  }
}

TEST_P(BusExchange, GivesAReaderOfLiveSamplesNoneOfTheBlocksBefore) {
  constexpr std::uint64_t before = 200;
  auto writer = this->writer<wire::SampleBlock>(topics::dau_samples, Profile::samples);
  for (std::uint64_t i = 0; i < before; ++i) {
    ASSERT_EQ(writer.write(block(i)), WriteOutcome::written);
  }
  auto reader = this->reader<wire::SampleBlock>(topics::dau_samples, Profile::live_samples);
  ASSERT_TRUE(wait_for_match(writer, reader));
  std::vector<std::uint64_t> numbers;
  std::uint64_t next = before;
  ASSERT_TRUE(wait_for([&] { // from when on cannot be known before one has come
    EXPECT_EQ(writer.write(block(next++)), WriteOutcome::written);
    reader.take([&](const wire::SampleBlock& block) { numbers.push_back(block.block()); });
    return numbers.size() >= 10;
  }));
  // As it is: a Cyclone DDS writer sends what it has kept to every reader in Fast DDS.
  const bool gets_history =
      GetParam().writer == Vendor::cyclone_dds && GetParam().reader == Vendor::fast_dds;
  EXPECT_TRUE(gets_history || numbers.front() >= before) << numbers.front();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    EXPECT_EQ(numbers[i], numbers.front() + i);
  }
}

// As those of a source are opened; see paced_late_joiner_blocks.
TEST_P(BusExchange, GivesAReaderOfLiveSamplesNoMoreOfTheBlocksBeforeThanIsKept) {
  struct Kept {
    Profile profile;
    int blocks;
  };
  for (const Kept kept : {Kept{Profile::live_samples, live_late_joiner_blocks},
                          Kept{Profile::paced_samples, paced_late_joiner_blocks}}) {
    constexpr std::uint64_t before = std::uint64_t{2} * repair_blocks;
    auto writer = this->writer<wire::SampleBlock>(topics::dau_samples, kept.profile);
    // What is sent to a reader that has ended reaches the next one of its participant.
    ASSERT_TRUE(wait_for([&] { return writer.matched_readers() == 0; }));
    for (std::uint64_t i = 0; i < before; ++i) {
      ASSERT_EQ(writer.write(block(i)), WriteOutcome::written);
    }
    auto reader = this->reader<wire::SampleBlock>(topics::dau_samples, Profile::live_samples);
    ASSERT_TRUE(wait_for_match(writer, reader));
    std::vector<std::uint64_t> numbers;
    std::uint64_t next = before;
    ASSERT_TRUE(wait_for([&] {
      EXPECT_EQ(writer.write(block(next++)), WriteOutcome::written);
      reader.take([&](const wire::SampleBlock& block) { numbers.push_back(block.block()); });
      return !numbers.empty() && numbers.back() >= before;
    }));
    const bool gets_history =
        GetParam().writer == Vendor::cyclone_dds && GetParam().reader == Vendor::fast_dds;
    EXPECT_GE(numbers.front() + (gets_history ? kept.blocks : 0), before);
  }
}

TEST_P(BusExchange, NeverHoldsAWriterOfLiveSamplesBack) {
  if (GetParam().reader == Vendor::cyclone_dds) {
    GTEST_SKIP() << "readers of one process share a queue in Cyclone DDS, and one that hangs holds "
                    "up the others of its process: tests/interop has one process a reader";
  }
  auto writer = this->writer<wire::SampleBlock>(topics::dau_samples, Profile::live_samples);
  auto hanging = this->reader<wire::SampleBlock>(topics::dau_samples, Profile::samples);
  auto reader = this->reader<wire::SampleBlock>(topics::dau_samples, Profile::live_samples);
  ASSERT_TRUE(wait_for([&] { return writer.matched_readers() == 2; }));
  std::uint64_t last = 0;
  std::uint64_t missing = 0;
  const auto take = [&] {
    reader.take([&](const wire::SampleBlock& block) {
      missing += last == 0 ? 0 : block.block() - last - 1;
      last = block.block();
    });
  };
  // Twice what the one that does not take may hold; the other has taken each batch before the next.
  constexpr std::uint64_t batch = 50;
  const auto begin = std::chrono::steady_clock::now();
  std::chrono::steady_clock::duration longest{};
  for (std::uint64_t written = 1; written <= std::uint64_t{2} * untaken_blocks;) {
    for (std::uint64_t i = 0; i < batch; ++i, ++written) {
      const auto before = std::chrono::steady_clock::now();
      ASSERT_EQ(writer.write(block(written, "dau", 1000)), WriteOutcome::written);
      longest = std::max(longest, std::chrono::steady_clock::now() - before);
    }
    ASSERT_TRUE(wait_for([&] {
      take();
      return last == written - 1;
    })) << last
        << " of " << written - 1;
  }
  EXPECT_EQ(missing, 0U);
  EXPECT_LT(longest, 500ms);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, tests::patience);
}

TEST_P(BusExchange, GivesALateJoinerThatAsksForThemTheNewestOfLiveSamples) {
  auto writer = this->writer<wire::SampleBlock>(topics::dau_samples, Profile::live_samples);
  constexpr std::uint64_t blocks = repair_blocks + 100;
  for (std::uint64_t i = 0; i < blocks; ++i) {
    ASSERT_EQ(writer.write(block(i)), WriteOutcome::written);
  }
  auto reader = this->reader<wire::SampleBlock>(topics::dau_samples, Profile::samples);
  std::vector<std::uint64_t> numbers;
  ASSERT_TRUE(wait_for([&] {
    reader.take([&](const wire::SampleBlock& block) { numbers.push_back(block.block()); });
    return !numbers.empty() && numbers.back() == blocks - 1;
  })) << numbers.size();
  // Fast DDS cannot keep less for late joiners than for repairs.
  const auto kept = static_cast<std::size_t>(
      GetParam().writer == Vendor::cyclone_dds ? live_late_joiner_blocks : repair_blocks);
  EXPECT_EQ(numbers.size(), kept);
  EXPECT_EQ(numbers.front(), blocks - kept);
}

TEST_P(BusExchange, GivesWhoCatchesUpEverythingFromTheFirstMessageOn) {
  // Matching on one side does not mean matching on the other: nothing may be lost between.
  for (int attempt = 0; attempt < 10; ++attempt) {
    const std::string asker = "asker-" + std::to_string(attempt);
    auto reader = reading_.reader(topics::catch_up_samples, asker, bell_).value();
    auto writer = writing_.writer(topics::catch_up_samples, asker).value();
    ASSERT_TRUE(wait_for([&] { return writer.matched_readers() == 1; }));
    constexpr std::uint64_t blocks = std::uint64_t{3} * catch_up_blocks;
    std::vector<std::uint64_t> numbers;
    const auto take = [&] {
      reader.take([&](const wire::SampleBlock& block) { numbers.push_back(block.block()); });
      return numbers.size() >= blocks;
    };
    for (std::uint64_t i = 0; i < blocks; ++i) {
      ASSERT_EQ(writer.write(block(i, "dau", 200)), WriteOutcome::written);
      take();
    }
    ASSERT_TRUE(wait_for(take)) << numbers.size();
    for (std::uint64_t i = 0; i < blocks; ++i) {
      ASSERT_EQ(numbers[i], i);
    }
  }
}

TEST_P(BusExchange, HoldsTheWriterBackWhenBlocksAreNotTakenAndLosesNone) {
  auto writer = this->writer<wire::SampleBlock>(topics::dau_samples, Profile::samples);
  auto reader = this->reader<wire::SampleBlock>(topics::dau_samples, Profile::samples);
  ASSERT_TRUE(wait_for_match(writer, reader));
  // 8 kB each, so that neither the depth at either end nor a buffer of bytes between them takes
  // them all.
  std::uint64_t written = 0;
  WriteOutcome outcome = WriteOutcome::written;
  for (; written < 20'000; ++written) {
    outcome = writer.write(block(written, "dau", 1000), 300ms);
    if (outcome != WriteOutcome::written) {
      break;
    }
  }
  EXPECT_EQ(outcome, WriteOutcome::timed_out);
  EXPECT_LE(written, static_cast<std::uint64_t>(late_joiner_blocks + untaken_blocks + 200));
  std::uint64_t next = 0;
  const auto take = [&] {
    reader.take([&](const wire::SampleBlock& block) {
      EXPECT_EQ(block.block(), next);
      next = block.block() + 1;
    });
    return next >= written;
  };
  ASSERT_TRUE(wait_for(take)) << next << " of " << written;
  ASSERT_EQ(writer.write(block(written, "dau", 1000)), WriteOutcome::written);
  ++written;
  ASSERT_TRUE(wait_for(take)) << next << " of " << written;
}

TEST_P(BusExchange, GivesALateJoinerTheNewestStateOfEveryKey) {
  auto writer = this->writer<wire::SourceStatus>(topics::source_status, Profile::state);
  wire::SourceStatus status;
  status.bench(bench_);
  for (std::uint64_t update = 1; update <= 10; ++update) {
    for (const char* source : {"dau", "acs", "can"}) {
      status.source(source);
      status.received(update);
      ASSERT_EQ(writer.write(status), WriteOutcome::written);
    }
  }
  auto reader = this->reader<wire::SourceStatus>(topics::source_status, Profile::state);
  std::map<std::string, std::vector<std::uint64_t>> seen;
  ASSERT_TRUE(wait_for([&] {
    reader.take([&](const wire::SourceStatus& sample) {
      seen[sample.source().to_string()].push_back(sample.received());
    });
    return seen.size() == 3;
  }));
  for (const auto& [source, updates] : seen) {
    EXPECT_EQ(updates, std::vector<std::uint64_t>{10}) << source;
  }
}

TEST_P(BusExchange, KeepsTheResultsOfThousandsOfKeys) {
  auto writer = this->writer<wire::CalibrationResult>(topics::calibration_result, Profile::results);
  constexpr std::uint32_t steps = 2000;
  wire::CalibrationResult result;
  result.bench(bench_);
  result.run("run-1");
  result.channel("dau/acceleration_z");
  for (std::uint32_t step = 0; step < steps; ++step) {
    result.step(step);
    result.frequency_hz(step * 0.5);
    ASSERT_EQ(writer.write(result), WriteOutcome::written);
  }
  auto reader = this->reader<wire::CalibrationResult>(topics::calibration_result, Profile::results);
  std::map<std::uint32_t, double> frequencies;
  ASSERT_TRUE(wait_for([&] {
    reader.take([&](const wire::CalibrationResult& sample) {
      frequencies[sample.step()] = sample.frequency_hz();
    });
    return frequencies.size() == steps;
  })) << frequencies.size();
  EXPECT_EQ(frequencies.at(1999), 999.5);
}

TEST_P(BusExchange, GivesNoOldCommandsToALateJoiner) {
  auto writer = this->writer<wire::Command>(topics::command, Profile::command);
  ASSERT_EQ(writer.write(command("dau", 1)), WriteOutcome::written);
  auto reader = this->reader<wire::Command>(topics::command, Profile::command);
  ASSERT_TRUE(wait_for_match(writer, reader));
  std::vector<std::string> runs;
  const auto take = [&] {
    reader.take([&](const wire::Command& sample) { runs.push_back(sample.run()); });
    return !runs.empty();
  };
  // One side may match before the other: commands are repeated until they are answered.
  for (std::uint32_t run = 2; run < 200; ++run) {
    ASSERT_EQ(writer.write(command("dau", run)), WriteOutcome::written);
    if (wait_for(take, 100ms)) {
      break;
    }
  }
  ASSERT_FALSE(runs.empty());
  EXPECT_NE(runs.front(), "1");
}

TEST_P(BusExchange, CarriesKeysOf1And64Characters) {
  auto writer = this->writer<wire::SampleBlock>(topics::acs_samples, Profile::samples);
  auto reader = this->reader<wire::SampleBlock>(topics::acs_samples, Profile::samples);
  const std::string shortest = "a";
  const std::string longest(64, 'z');
  for (std::uint64_t i = 0; i < 20; ++i) {
    for (const std::string& source : {shortest, longest}) {
      ASSERT_EQ(writer.write(block(i, source)), WriteOutcome::written);
    }
  }
  std::map<std::string, std::uint64_t> next;
  ASSERT_TRUE(wait_for([&] {
    reader.take([&](const wire::SampleBlock& block) {
      EXPECT_EQ(block.block(), next[block.source().to_string()]++);
    });
    return next[shortest] == 20 && next[longest] == 20;
  }));
  EXPECT_EQ(next.size(), 2U);
}

TEST_P(BusExchange, SaysNothingOfInstancesWhenAWriterGoes) {
  auto reader = this->reader<wire::SourceStatus>(topics::source_status, Profile::state);
  auto writer = std::make_unique<Writer<wire::SourceStatus>>(
      this->writer<wire::SourceStatus>(topics::source_status, Profile::state));
  wire::SourceStatus status;
  status.bench(bench_);
  status.source("dau");
  ASSERT_EQ(writer->write(status), WriteOutcome::written);
  std::size_t valid = 0;
  ASSERT_TRUE(wait_for([&] {
    reader.take([&](const wire::SourceStatus&) { ++valid; });
    return valid == 1;
  }));
  writer.reset();
  ASSERT_TRUE(wait_for([&] { return reader.matched_writers() == 0; }));
}

TEST_P(BusExchange, DestroysAWriterWhileAReaderStillLacksItsSamples) {
  wire::CalibrationResult result;
  result.bench(bench_);
  for (int attempt = 0; attempt < 20; ++attempt) {
    const auto reader =
        this->reader<wire::CalibrationResult>(topics::calibration_result, Profile::results);
    auto writer =
        this->writer<wire::CalibrationResult>(topics::calibration_result, Profile::results);
    for (std::uint32_t step = 0; step < 1000; ++step) {
      result.step(step);
      ASSERT_EQ(writer.write(result), WriteOutcome::written);
    }
    ASSERT_TRUE(wait_for([&] { return writer.matched_readers() == 1; }));
  } // the writer first, then the reader
}

TEST_P(BusExchange, RingsForWhatComesAndForWhatWasThere) {
  auto writer = this->writer<wire::SampleBlock>(topics::dau_samples, Profile::samples);
  ASSERT_EQ(writer.write(block(0)), WriteOutcome::written);
  auto reader = this->reader<wire::SampleBlock>(topics::dau_samples, Profile::samples);
  for (std::uint64_t expected = 0; expected < 3; ++expected) {
    if (expected > 0) {
      ASSERT_EQ(writer.write(block(expected)), WriteOutcome::written);
    }
    bool got = false;
    const auto deadline = std::chrono::steady_clock::now() + tests::patience;
    while (!got) {
      ASSERT_TRUE(bell_->wait_until(deadline)) << "block " << expected << " came without a ring";
      reader.take([&](const wire::SampleBlock& block) { got = block.block() == expected; });
    }
  }
}

TEST_P(BusExchange, KeepsPartitionsApartAndReadsAllWithAStar) {
  auto mine =
      writing_.writer<wire::Command>(topics::command, Profile::state, bench_ + "-a").value();
  auto other =
      writing_.writer<wire::Command>(topics::command, Profile::state, bench_ + "-b").value();
  auto one =
      reading_.reader<wire::Command>(topics::command, Profile::state, bench_ + "-a", bell_).value();
  auto all =
      reading_.reader<wire::Command>(topics::command, Profile::state, bench_ + "*", bell_).value();
  wire::Command to_dau = command("dau", 1);
  to_dau.bench(bench_ + "-a");
  ASSERT_EQ(mine.write(to_dau), WriteOutcome::written);
  wire::Command to_acs = command("acs", 2);
  to_acs.bench(bench_ + "-b");
  ASSERT_EQ(other.write(to_acs), WriteOutcome::written);
  std::vector<std::string> of_one;
  std::vector<std::string> of_all;
  ASSERT_TRUE(wait_for([&] {
    one.take([&](const wire::Command& sample) { of_one.push_back(sample.target().to_string()); });
    all.take([&](const wire::Command& sample) { of_all.push_back(sample.target().to_string()); });
    return of_one.size() == 1 && of_all.size() == 2;
  }));
  EXPECT_EQ(of_one, std::vector<std::string>{"dau"});
}

TEST_P(BusExchange, GivesWhoReadsOneRunNothingOfOthersAndWhoReadsTheBenchAll) {
  const auto result_of = [this](const char* run) {
    wire::CalibrationResult result;
    result.bench(bench_);
    result.run(run);
    return result;
  };
  std::vector<Writer<wire::CalibrationResult>> writers;
  for (const char* run : {"before", "now"}) {
    writers.push_back(writing_.writer_of_run(topics::calibration_result, bench_, run).value());
    ASSERT_EQ(writers.back().write(result_of(run)), WriteOutcome::written);
  }
  auto one = reading_.reader_of_run(topics::calibration_result, bench_, "now", bell_).value();
  auto all = reading_.reader(topics::calibration_result, bench_, bell_).value();
  std::vector<std::string> of_one;
  std::vector<std::string> of_all;
  ASSERT_TRUE(wait_for([&] {
    one.take([&](const auto& sample) { of_one.push_back(sample.run().to_string()); });
    all.take([&](const auto& sample) { of_all.push_back(sample.run().to_string()); });
    return !of_one.empty() && of_all.size() == 2;
  }));
  EXPECT_EQ(of_one, std::vector<std::string>{"now"});
  EXPECT_EQ(one.matched_writers(), 1);
}

TEST_P(BusExchange, LetsProbesWaitForNobody) {
  auto writer = this->writer<wire::Command>(topics::command, Profile::probe);
  auto reader = this->reader<wire::Command>(topics::command, Profile::probe);
  auto reliable = this->reader<wire::Command>(topics::command, Profile::command);
  ASSERT_TRUE(wait_for_match(writer, reader)) << "and with no reader that asks for repairs";
  for (std::uint32_t i = 0; i < 2000; ++i) {
    ASSERT_EQ(writer.write(command("dau", i), 0s), WriteOutcome::written) << i;
  }
  std::vector<std::uint32_t> come;
  ASSERT_TRUE(wait_for([&] {
    reader.take([&](const wire::Command& one) {
      come.push_back(static_cast<std::uint32_t>(std::stoul(one.run())));
    });
    return !come.empty();
  }));
  EXPECT_EQ(std::ranges::adjacent_find(come, std::ranges::greater_equal()), come.end());
  EXPECT_EQ(writer.matched_readers(), 1);
  EXPECT_EQ(reliable.matched_writers(), 0);
}

TEST_P(BusExchange, LetsParticipantsGoBeforeTheirWritersAndReaders) {
  std::unique_ptr<Writer<wire::SampleBlock>> writer;
  std::unique_ptr<Reader<wire::SampleBlock>> reader;
  {
    Participant participant = join(GetParam().writer);
    writer = std::make_unique<Writer<wire::SampleBlock>>(
        participant.writer<wire::SampleBlock>("DauSamples", Profile::samples, bench_).value());
  }
  {
    Participant participant = join(GetParam().reader);
    reader = std::make_unique<Reader<wire::SampleBlock>>(
        participant.reader<wire::SampleBlock>("DauSamples", Profile::samples, bench_, bell_)
            .value());
  }
  ASSERT_EQ(writer->write(block(0)), WriteOutcome::written);
  EXPECT_TRUE(wait_for([&] { return reader->take([](const wire::SampleBlock&) {}) == 1; }));
}

} // namespace
} // namespace dyncal::bus
