// Programs of different versions, and programs that do not keep to the contract, on one bus.
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/type_support_of.hpp"
#include "services/contract/topics.hpp"
#include "tests/unit/services/bus/bus_pair.hpp"

namespace dyncal::bus {
namespace {

// Command as a later version could have it: two members more, and their checksum.
struct NewerCommand : wire::Command {
  double at_utc_s = 0.0;
  std::string reason;
  std::uint32_t newer_checksum = 0;

  [[nodiscard]] std::uint32_t checksum() const { return newer_checksum; }
  void checksum(std::uint32_t value) { newer_checksum = value; }
  template <class Message, class Visit>
  static void visit_members(Message& message, Visit&& visit) {
    Command::visit_members(message, visit);
    visit(message.at_utc_s);
    visit(message.reason);
    visit(message.newer_checksum);
  }
};

// Its bytes end in the middle of a member.
struct BrokenCommand : wire::Command {
  template <class Message, class Visit>
  static void visit_members(Message& /*message*/, Visit&& visit) {
    std::string bench = "bench";
    std::string target = "broken";
    std::uint32_t kind = 0;
    std::uint32_t length_of_run = 1000;
    visit(bench);
    visit(target);
    visit(kind);
    visit(length_of_run);
  }
};

// A byte of `sender` is changed on the way.
struct ChangedCommand : wire::Command {};

// Its key is longer than the contract allows.
struct LongKeyCommand : wire::Command {
  template <class Message, class Visit>
  static void visit_members(Message& /*message*/, Visit&& visit) {
    std::string bench = "b";
    std::string target(150, 'k');
    std::uint32_t kind = 0;
    std::string rest = "r";
    visit(bench);
    visit(target);
    visit(kind);
    visit(rest);
    visit(rest);
  }
};

} // namespace

template <>
inline constexpr std::size_t appended_bytes<NewerCommand> = 64;

template <>
const TypeSupport& type_support<NewerCommand>() {
  static const TypeSupport support =
      make_type_support<NewerCommand>("dyncal::wire::Command", KeyLayout{{64, 64}, 0});
  return support;
}
template <>
const TypeSupport& type_support<BrokenCommand>() {
  static const TypeSupport support =
      make_type_support<BrokenCommand>("dyncal::wire::Command", KeyLayout{{64, 64}, 0});
  return support;
}
template <>
const TypeSupport& type_support<ChangedCommand>() {
  static const TypeSupport support = [] {
    TypeSupport changing =
        make_type_support<ChangedCommand>("dyncal::wire::Command", KeyLayout{{64, 64}, 0});
    changing.serialize = [](const void* sample, char* bytes, std::size_t capacity) {
      const std::size_t count = Encoder<ChangedCommand>::serialize(sample, bytes, capacity);
      const std::size_t at = std::string_view(bytes, count).find("test");
      bytes[at] = 'b';
      return count;
    };
    return changing;
  }();
  return support;
}
template <>
const TypeSupport& type_support<LongKeyCommand>() {
  static const TypeSupport support =
      make_type_support<LongKeyCommand>("dyncal::wire::Command", KeyLayout{{64, 200}, 0});
  return support;
}

namespace {

class BusEvolution : public BusPair {
protected:
  template <class T>
  T filled() const {
    T command;
    command.bench(bench_);
    command.target("dau");
    command.run("run-7");
    command.sender("test");
    return command;
  }

  // Takes until the sample sent last, whose target is "last", has come; returns what came before
  // it.
  template <class T>
  std::vector<T> take_until_last(Reader<T>& reader) {
    std::vector<T> samples;
    bool last = false;
    EXPECT_TRUE(wait_for([&] {
      reader.take([&](const T& sample) {
        if (sample.target() == "last") {
          last = true;
        } else {
          samples.push_back(sample);
        }
      });
      return last;
    }));
    return samples;
  }

  // Of two writers.
  template <class Bad>
  void expect_only_the_bad_one_dropped();

  // Two writers have no order between them: the malformed message may come after the good one.
  [[nodiscard]] bool comes_to_be_counted(Reader<wire::Command>& reader) {
    return wait_for([&] {
      reader.take([](const wire::Command&) {});
      return reading_.malformed_messages() >= 1;
    });
  }
};

INSTANTIATE_TEST_SUITE_P(AllBuses, BusEvolution, testing::ValuesIn(carrier_pairs()), pair_name);

TEST_P(BusEvolution, LetsAnOlderProgramReadANewerOne) {
  auto writer = this->writer<NewerCommand>(topics::command, Profile::state);
  auto reader = this->reader<wire::Command>(topics::command, Profile::state);
  auto command = filled<NewerCommand>();
  command.at_utc_s = 1.5;
  command.reason = "because";
  ASSERT_EQ(writer.write(command), WriteOutcome::written);
  command.target("last");
  ASSERT_EQ(writer.write(command), WriteOutcome::written);
  EXPECT_EQ(take_until_last(reader), std::vector<wire::Command>{filled<wire::Command>()});
}

TEST_P(BusEvolution, LetsANewerProgramReadAnOlderOneWithZerosForWhatItLacks) {
  auto writer = this->writer<wire::Command>(topics::command, Profile::state);
  auto reader = this->reader<NewerCommand>(topics::command, Profile::state);
  auto command = filled<wire::Command>();
  ASSERT_EQ(writer.write(command), WriteOutcome::written);
  command.target("last");
  ASSERT_EQ(writer.write(command), WriteOutcome::written);
  const auto samples = take_until_last(reader);
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0].sender(), "test");
  EXPECT_EQ(samples[0].at_utc_s, 0.0);
  EXPECT_EQ(samples[0].reason, "");
}

TEST_P(BusEvolution, ReadsAnEnumValueThatALaterVersionAppended) {
  auto writer = this->writer<wire::Command>(topics::command, Profile::state);
  auto reader = this->reader<wire::Command>(topics::command, Profile::state);
  auto command = filled<wire::Command>();
  command.kind(static_cast<wire::CommandKind>(1234));
  ASSERT_EQ(writer.write(command), WriteOutcome::written);
  auto last = filled<wire::Command>();
  last.target("last");
  ASSERT_EQ(writer.write(last), WriteOutcome::written);
  EXPECT_EQ(take_until_last(reader), std::vector<wire::Command>{command});
}

template <class Bad>
void BusEvolution::expect_only_the_bad_one_dropped() {
  auto bad_writer = this->writer<Bad>(topics::command, Profile::state);
  auto reader = this->reader<wire::Command>(topics::command, Profile::state);
  ASSERT_EQ(bad_writer.write(filled<Bad>()), WriteOutcome::written);
  Participant third = join(GetParam().writer);
  auto writer = third.writer<wire::Command>(topics::command, Profile::state, bench_).value();
  ASSERT_TRUE(wait_for([&] { return reader.matched_writers() == 2; }));
  bad_writer.wait_for_acknowledgments(std::chrono::seconds(1));
  auto command = filled<wire::Command>();
  ASSERT_EQ(writer.write(command), WriteOutcome::written);
  command.target("last");
  ASSERT_EQ(writer.write(command), WriteOutcome::written);
  EXPECT_EQ(take_until_last(reader), std::vector<wire::Command>{filled<wire::Command>()});
  EXPECT_TRUE(comes_to_be_counted(reader));
  EXPECT_THAT(warnings_, testing::Contains(testing::HasSubstr("dyncal::wire::Command")).Times(1));
}

TEST_P(BusEvolution, DropsABrokenMessageAndNothingElse) {
  expect_only_the_bad_one_dropped<BrokenCommand>();
}

TEST_P(BusEvolution, DropsAMessageThatWasChangedOnItsWayAndNothingElse) {
  expect_only_the_bad_one_dropped<ChangedCommand>();
}

TEST_P(BusEvolution, DropsAMessageWhoseKeyIsTooLongInsteadOfCuttingIt) {
  auto long_writer = this->writer<LongKeyCommand>(topics::command, Profile::state);
  auto reader = this->reader<wire::Command>(topics::command, Profile::state);
  ASSERT_EQ(long_writer.write(filled<LongKeyCommand>()), WriteOutcome::written);
  Participant third = join(GetParam().writer);
  auto writer = third.writer<wire::Command>(topics::command, Profile::state, bench_).value();
  ASSERT_TRUE(wait_for([&] { return reader.matched_writers() == 2; }));
  long_writer.wait_for_acknowledgments(std::chrono::seconds(1));
  auto command = filled<wire::Command>();
  command.target("last");
  ASSERT_EQ(writer.write(command), WriteOutcome::written);
  EXPECT_TRUE(take_until_last(reader).empty());
  EXPECT_TRUE(comes_to_be_counted(reader));
  EXPECT_THAT(warnings_, testing::Contains(testing::HasSubstr("dyncal::wire::Command")).Times(1));
}

} // namespace
} // namespace dyncal::bus
