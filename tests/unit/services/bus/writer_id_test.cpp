// That every message names the writer and the program that it came from, over each pair of vendors.
#include "services/bus/writer_id.hpp"

#include <map>
#include <set>

#include "tests/unit/services/bus/bus_pair.hpp"

namespace dyncal::bus {
namespace {

class WriterIds : public BusPair {};

INSTANTIATE_TEST_SUITE_P(AllBuses, WriterIds, testing::ValuesIn(carrier_pairs()), pair_name);

TEST_P(WriterIds, AreThoseOfTheWritersAndOfTheirPrograms) {
  Participant other = join(GetParam().writer);
  auto reader = this->reader<wire::Command>(topics::command, Profile::state);
  std::map<std::string, Writer<wire::Command>> writers;
  writers.emplace("first", this->writer<wire::Command>(topics::command, Profile::state));
  writers.emplace("second", this->writer<wire::Command>(topics::command, Profile::state));
  writers.emplace("other",
                  other.writer<wire::Command>(topics::command, Profile::state, bench_).value());
  ASSERT_TRUE(wait_for([&] { return reader.matched_writers() == 3; }));
  std::map<std::string, std::set<std::string>> guids;
  std::map<std::string, std::string> programs;
  int taken = 0;
  for (int round = 1; round <= 3; ++round) {
    for (auto& [name, writer] : writers) {
      wire::Command command;
      command.bench(bench_);
      command.target(name);
      command.run(std::to_string(round));
      ASSERT_EQ(writer.write(command), WriteOutcome::written);
    }
    ASSERT_TRUE(wait_for([&] {
      reader.take_with_writer([&](const wire::Command& command, const WriterId& writer) {
        ++taken;
        EXPECT_TRUE(writer.is_known());
        guids[command.target().to_string()].insert(
            hexadecimal(writer.guid.data(), writer.guid.size()));
        programs[command.target().to_string()] = writer.participant();
      });
      return taken == 3 * round;
    }));
  }
  ASSERT_EQ(guids.size(), 3U);
  std::set<std::string> all;
  for (const auto& [name, of_writer] : guids) {
    EXPECT_EQ(of_writer.size(), 1U) << name;
    all.insert(of_writer.begin(), of_writer.end());
  }
  EXPECT_EQ(all.size(), 3U);
  EXPECT_EQ(programs["first"], programs["second"]);
  EXPECT_NE(programs["first"], programs["other"]);
  EXPECT_EQ(programs["first"].size(), 2 * guid_prefix_bytes);
}

} // namespace
} // namespace dyncal::bus
