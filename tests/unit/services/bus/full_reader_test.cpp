// A reader that is full while samples come for it ends all the same: a program that is stopped when
// it has fallen behind must not hang.
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <future>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "services/bus/bus.hpp"
#include "services/bus/qos_profiles.hpp"
#include "services/contract/topics.hpp"
#include "tests/dds_domain.hpp"

namespace dyncal::bus {
namespace {

using namespace std::chrono_literals;

constexpr const char* write_option = "--write";
constexpr const char* bench = "full";
constexpr std::size_t values_per_block = 500;
constexpr std::chrono::seconds ending_time{60}; // on a busy machine; it ends within one

Participant join(Vendor vendor, int domain) {
  ParticipantOptions options;
  options.vendor = vendor;
  options.domain = domain;
  options.name = "full reader test";
  options.interface_name = "lo";
  return Participant::create(options).value();
}

// Writes blocks for as long as it lives, and a letter to its standard output once its reader is
// full: it holds the writer up, or has had more than it may hold.
[[noreturn]] void write_for_ever(Vendor vendor, int domain) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  Participant participant = join(vendor, domain);
  auto writer =
      participant.writer<wire::SampleBlock>(topics::acs_samples, Profile::live_samples, bench)
          .value();
  wire::SampleBlock block;
  block.bench(bench);
  block.source("acs");
  block.session(1);
  block.sample_count(values_per_block);
  block.channel_count(1);
  block.values().resize(values_per_block);
  bool is_said = false;
  for (std::uint64_t number = 0;;) {
    if (writer.matched_readers() == 0) {
      std::this_thread::sleep_for(1ms); // the number of readers has no bell
      continue;
    }
    block.block(number);
    block.first_sample(number * values_per_block);
    const bool written = writer.write(block, 500ms) == WriteOutcome::written;
    number += written ? 1 : 0;
    if ((!written || number == 3 * untaken_blocks) && !std::exchange(is_said, true)) {
      static_cast<void>(::write(STDOUT_FILENO, "f", 1) < 0);
    }
  }
}

class WritingProcess {
public:
  WritingProcess(Vendor vendor, int domain) {
    int ends[2] = {};
    static_cast<void>(pipe(ends) < 0);
    const std::string name = to_string(vendor);
    const std::string number = std::to_string(domain);
    process_ = fork();
    if (process_ == 0) {
      dup2(ends[1], STDOUT_FILENO);
      execl("/proc/self/exe", "writer", write_option, name.c_str(), number.c_str(), nullptr);
      _exit(1);
    }
    close(ends[1]);
    letters_ = ends[0];
  }
  WritingProcess(const WritingProcess&) = delete;
  WritingProcess& operator=(const WritingProcess&) = delete;
  ~WritingProcess() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    close(letters_);
  }
  // False: it has ended.
  [[nodiscard]] bool wait_until_full() const {
    char letter = 0;
    return read(letters_, &letter, 1) == 1;
  }

private:
  pid_t process_ = -1;
  int letters_ = -1;
};

class FullReader : public testing::TestWithParam<Vendor> {};

TEST_P(FullReader, EndsWhileSamplesComeForIt) {
  const int domain = tests::own_dds_domain();
  std::optional<Participant> participant = join(GetParam(), domain);
  auto reader = std::make_unique<Reader<wire::SampleBlock>>(
      participant
          ->reader<wire::SampleBlock>(topics::acs_samples, Profile::live_samples, bench, nullptr)
          .value());
  const WritingProcess writer(GetParam(), domain);
  ASSERT_TRUE(writer.wait_until_full());
  std::promise<void> ended;
  std::thread ending([&] {
    reader.reset();
    participant.reset();
    ended.set_value();
  });
  if (ended.get_future().wait_for(ending_time) != std::future_status::ready) {
    std::fprintf(stderr, "a full reader does not end\n");
    _exit(1); // its thread cannot be ended
  }
  ending.join();
}

INSTANTIATE_TEST_SUITE_P(Vendors, FullReader, testing::ValuesIn(vendors_in_this_build()),
                         [](const auto& tested) { return to_string(tested.param); });

} // namespace
} // namespace dyncal::bus

int main(int argc, char** argv) {
  if (argc == 4 && std::string(argv[1]) == dyncal::bus::write_option) {
    dyncal::bus::write_for_ever(dyncal::bus::parse_vendor(argv[2]).value(), std::stoi(argv[3]));
  }
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
