// A reader that comes when a writer has long written: what is still there of its first and of its
// last messages comes, though all numbers between are gone, and it takes no memory for these. The
// same once the writer has begun anew. Prints how long that took, and how long the program heard
// nothing of another meanwhile.
//
// DYNCAL_MESSAGES_BEFORE gives how many it has written (50000).
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "services/bus/bus.hpp"
#include "services/contract/topics.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"

namespace dyncal::bus {
namespace {

using Steady = std::chrono::steady_clock;

constexpr const char* bench = "late";
constexpr std::chrono::milliseconds pace{20};
constexpr double max_growth_mb = 60.0; // a participant included

Participant join(Vendor vendor) {
  ParticipantOptions options;
  options.vendor = vendor;
  options.domain = tests::own_dds_domain();
  options.name = "late reader test";
  options.interface_name = "lo";
  return Participant::create(options).value();
}

wire::Command message(const std::string& target, std::uint32_t number) {
  wire::Command command;
  command.bench(bench);
  command.target(target);
  command.step(number);
  return command;
}

double resident_mb() {
  std::ifstream status("/proc/self/statm");
  double total_pages = 0;
  double pages = 0;
  status >> total_pages >> pages;
  return pages * 4096 / 1e6;
}

class LateReader : public testing::TestWithParam<std::tuple<Vendor, Vendor>> {
protected:
  using Writing = Writer<wire::Command>;
  using Reading = Reader<wire::Command>;

  std::uint32_t write_many() {
    const char* wanted = std::getenv("DYNCAL_MESSAGES_BEFORE");
    const auto many = static_cast<std::uint32_t>(wanted == nullptr ? 50'000 : std::atoi(wanted));
    writer_->write(message("first", 1), pace);
    for (std::uint32_t number = 1; number <= many; ++number) {
      writer_->write(message("last", number), pace);
    }
    return many;
  }
  // Returns whether first and last message of the writer came. `longest_s_`: without one of the
  // other program, which goes on writing.
  bool hears_both(Reading& reader, std::uint32_t last) {
    bool first_came = false;
    bool last_came = false;
    const auto began = Steady::now();
    const std::clock_t used = std::clock();
    auto heard_other = Steady::now();
    for (std::uint32_t number = 1; Steady::now() - began < tests::patience; ++number) {
      other_writer_.write(message("other", number), pace);
      bell_->wait_until(Steady::now() + pace);
      other_reader_.take([&](const wire::Command& /*message*/) {
        longest_s_ = std::max(longest_s_, seconds_since(heard_other));
        heard_other = Steady::now();
      });
      reader.take([&](const wire::Command& command) {
        first_came = first_came || command.target() == "first";
        last_came = last_came || (command.target() == "last" && command.step() == last);
      });
      if (first_came && last_came) {
        longest_s_ = std::max(longest_s_, seconds_since(heard_other));
        std::cout << last << " messages before: both came after " << seconds_since(began)
                  << " s and " << static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC
                  << " s of processor time, others at most " << longest_s_ << " s apart\n";
        return true;
      }
    }
    return false;
  }
  static double seconds_since(Steady::time_point instant) {
    return std::chrono::duration<double>(Steady::now() - instant).count();
  }
  Reading late_reader() {
    return reading_.reader<wire::Command>("Late", Profile::state, "*", bell_).value();
  }

  Participant writing_ = join(std::get<0>(GetParam()));
  Participant reading_ = join(std::get<1>(GetParam()));
  Participant other_ = join(std::get<0>(GetParam()));
  std::shared_ptr<WakeUp> bell_ = std::make_shared<WakeUp>();
  std::optional<Writing> writer_ =
      writing_.writer<wire::Command>("Late", Profile::state, bench).value();
  Writing other_writer_ = other_.writer<wire::Command>("Other", Profile::state, bench).value();
  Reading other_reader_ =
      reading_.reader<wire::Command>("Other", Profile::state, "*", bell_).value();
  double longest_s_ = 0.0;
};

TEST_P(LateReader, HearsFirstAndLastMessageOfAWriterThatHasLongWritten) {
  const std::uint32_t many = write_many();
  const double before_mb = resident_mb();
  Reading reader = late_reader();
  ASSERT_TRUE(hears_both(reader, many));
  EXPECT_LT(resident_mb() - before_mb, max_growth_mb);
  writer_->write(message("last", many + 1), pace);
  Reading later = late_reader();
  EXPECT_TRUE(hears_both(later, many + 1));
}

TEST_P(LateReader, HearsAWriterThatHasBegunAnew) {
  Reading reader = late_reader();
  ASSERT_TRUE(hears_both(reader, write_many()));
  writer_.reset();
  writer_ = writing_.writer<wire::Command>("Late", Profile::state, bench).value();
  writer_->write(message("first", 1), pace);
  writer_->write(message("last", 7), pace);
  EXPECT_TRUE(hears_both(reader, 7));
}

std::string pair_name(const testing::TestParamInfo<std::tuple<Vendor, Vendor>>& pair) {
  return std::string(to_string(std::get<0>(pair.param))) + "_to_" +
         std::string(to_string(std::get<1>(pair.param)));
}

INSTANTIATE_TEST_SUITE_P(Vendors, LateReader,
                         testing::Combine(testing::ValuesIn(vendors_in_this_build()),
                                          testing::ValuesIn(vendors_in_this_build())),
                         pair_name);

} // namespace
} // namespace dyncal::bus
