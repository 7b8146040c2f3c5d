// A program that was stopped for longer than its lease, and goes on: the others have forgotten it,
// and whether it has forgotten them depends on which of its threads runs first. They must hear each
// other again either way, on every topic and in both directions.
//
// DYNCAL_STOPS gives how many times it is stopped (2).
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "services/bus/bus.hpp"
#include "services/contract/topics.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"

namespace dyncal::bus {
namespace {

using Steady = std::chrono::steady_clock;

constexpr const char* echo_option = "--echo";
constexpr const char* bench = "stopped";
constexpr std::chrono::milliseconds pace{50};
constexpr std::chrono::seconds settled{2}; // after it goes on: what was under way has come

struct Call {
  const char* topic;
  Profile profile;
};
constexpr Call calls[] = {{"StateCall", Profile::state}, {"LiveCall", Profile::live_samples}};

// Writes a number on each topic, and hears those of others.
class Caller {
public:
  Caller(Vendor vendor, int domain, std::string name)
      : name_(std::move(name)), participant_(join(vendor, domain)) {
    for (const Call& call : calls) {
      writers_.push_back(
          participant_.writer<wire::Command>(call.topic, call.profile, bench).value());
      readers_.push_back(
          participant_.reader<wire::Command>(call.topic, call.profile, "*", bell_).value());
    }
  }

  void call(std::uint32_t number) {
    wire::Command command;
    command.bench(bench);
    command.target(name_);
    command.step(number);
    for (auto& writer : writers_) {
      writer.write(command, pace);
    }
  }
  // The lower one of the newest numbers that came on each topic.
  std::uint32_t hear() {
    bell_->wait_until(Steady::now() + pace);
    for (std::size_t i = 0; i < readers_.size(); ++i) {
      readers_[i].take([&](const wire::Command& command) {
        if (command.target() != name_.c_str()) {
          heard_[i] = command.step();
        }
      });
    }
    return *std::min_element(std::begin(heard_), std::end(heard_));
  }

private:
  static Participant join(Vendor vendor, int domain) {
    ParticipantOptions options;
    options.vendor = vendor;
    options.domain = domain;
    options.name = "stopped participant test";
    options.interface_name = "lo";
    return Participant::create(options).value();
  }

  std::string name_;
  std::shared_ptr<WakeUp> bell_ = std::make_shared<WakeUp>();
  Participant participant_;
  std::vector<Writer<wire::Command>> writers_;
  std::vector<Reader<wire::Command>> readers_;
  std::uint32_t heard_[std::size(calls)] = {};
};

// In a process of its own, this program's: calls what it hears.
class Echo {
public:
  explicit Echo(Vendor vendor) {
    const std::string name = to_string(vendor);
    const std::string domain = std::to_string(tests::own_dds_domain());
    process_ = fork();
    if (process_ == 0) {
      execl("/proc/self/exe", "echo", echo_option, name.c_str(), domain.c_str(), nullptr);
      _exit(1);
    }
  }
  Echo(const Echo&) = delete;
  Echo& operator=(const Echo&) = delete;
  ~Echo() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  void send(int signal) const { kill(process_, signal); }

private:
  pid_t process_ = -1;
};

struct StoppedPair {
  Vendor stopped;
  Vendor other;
};

std::vector<StoppedPair> stopped_pairs() {
  std::vector<StoppedPair> pairs;
  for (const Vendor stopped : vendors_in_this_build()) {
    for (const Vendor other : vendors_in_this_build()) {
      pairs.push_back({stopped, other});
    }
  }
  return pairs;
}

class StoppedParticipant : public testing::TestWithParam<StoppedPair> {
protected:
  Echo echo_{GetParam().stopped};
  Caller caller_{GetParam().other, tests::own_dds_domain(), "caller"};
  std::uint32_t number_ = 0;

  // Calls until the echo of a number that is called `after` from now comes.
  bool wait_for_echo(Steady::duration after) {
    const auto begin = Steady::now();
    std::uint32_t wanted = 0;
    while (Steady::now() < begin + after + tests::patience) {
      caller_.call(++number_);
      if (wanted == 0 && Steady::now() >= begin + after) {
        wanted = number_;
      }
      if (caller_.hear() >= wanted && wanted > 0) {
        return true;
      }
    }
    return false;
  }
  void call_for(Steady::duration time) {
    for (const auto end = Steady::now() + time; Steady::now() < end;) {
      caller_.call(++number_);
      caller_.hear();
    }
  }
};

TEST_P(StoppedParticipant, IsHeardAgainAndHears) {
  const char* wanted = std::getenv("DYNCAL_STOPS");
  const int stops = wanted != nullptr ? std::atoi(wanted) : 2;
  ASSERT_GT(stops, 0);
  ASSERT_TRUE(wait_for_echo(std::chrono::seconds(0)));
  std::minstd_rand chance(4711);
  for (int stop = 0; stop < stops; ++stop) {
    const std::chrono::milliseconds away(std::uniform_int_distribution(2'000, 5'000)(chance));
    echo_.send(SIGSTOP);
    call_for(away);
    echo_.send(SIGCONT);
    ASSERT_TRUE(wait_for_echo(settled)) << "stopped for " << away.count() << " ms";
  }
}

INSTANTIATE_TEST_SUITE_P(EachPairOfVendors, StoppedParticipant, testing::ValuesIn(stopped_pairs()),
                         [](const auto& pair) {
                           return to_string(pair.param.stopped) + "_by_" +
                                  to_string(pair.param.other);
                         });

[[noreturn]] void be_the_echo(const std::string& vendor, int domain) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (Caller caller(parse_vendor(vendor).value(), domain, "echo");;) {
    caller.call(caller.hear());
  }
}

} // namespace
} // namespace dyncal::bus

int main(int count, char** arguments) {
  if (count == 4 && std::string(arguments[1]) == dyncal::bus::echo_option) {
    dyncal::bus::be_the_echo(arguments[2], std::atoi(arguments[3]));
  }
  testing::InitGoogleTest(&count, arguments);
  return RUN_ALL_TESTS();
}
