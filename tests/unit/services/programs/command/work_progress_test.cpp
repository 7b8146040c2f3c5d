#include "services/programs/command/work_progress.hpp"

#include <pty.h>
#include <unistd.h>

#include <array>
#include <cstdio>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;

std::string text(std::size_t done, std::size_t total, double passed_s) {
  return progress_text({"evaluating", "steps", total, done, {}}, passed_s);
}

TEST(WorkProgress, SaysTheTimeLeft) {
  EXPECT_EQ(text(0, 0, 3.2), "evaluating: 4 s");
  EXPECT_EQ(text(0, 51, 3.0), "evaluating: 0 of 51 steps, 3 s");
  EXPECT_EQ(text(12, 51, 24.0), "evaluating: 12 of 51 steps, 78 s left");
  EXPECT_EQ(text(1, 101, 10.0), "evaluating: 1 of 101 steps, 17 min left");
  EXPECT_EQ(text(53, 51, 24.0), "evaluating: 51 of 51 steps, 0 s left");
}

TEST(WorkProgress, SaysAShareWhereNothingIsCounted) {
  WorkCount count("reading");
  count.begin_share("fitting");
  EXPECT_EQ(progress_text(count.state(), 1.0), "fitting: 0 %, 1 s");
  count.set_share_done(0.256);
  EXPECT_EQ(progress_text(count.state(), 1.0), "fitting: 25 %, 3 s left");
  count.set_share_done(1.0);
  EXPECT_EQ(progress_text(count.state(), 4.0), "fitting: 100 %, 0 s left");
}

TEST(WorkProgress, IsSilentWhereThereIsNoTerminal) {
  std::FILE* file = std::tmpfile();
  {
    WorkProgress progress("evaluating", file, 0ms);
    progress.count()->begin("evaluating", "steps", 3);
    progress.count()->add_done();
    progress.clear();
  }
  EXPECT_EQ(std::ftell(file), 0);
  std::fclose(file);
}

class WorkProgressOnTerminal : public testing::Test {
protected:
  WorkProgressOnTerminal() {
    int slave = -1;
    if (openpty(&master_, &slave, nullptr, nullptr, nullptr) == 0) {
      terminal = fdopen(slave, "w");
    }
  }
  ~WorkProgressOnTerminal() override {
    if (terminal != nullptr) {
      std::fclose(terminal);
    }
    close(master_);
  }

  // Until it is there.
  std::string read_until(const std::string& part) {
    std::array<char, 512> piece{};
    while (shown_.find(part) == std::string::npos) {
      const ssize_t length = read(master_, piece.data(), piece.size());
      if (length <= 0) {
        break;
      }
      shown_.append(piece.data(), static_cast<std::size_t>(length));
    }
    return shown_;
  }

  std::FILE* terminal = nullptr;

private:
  int master_ = -1;
  std::string shown_;
};

TEST_F(WorkProgressOnTerminal, DrawsOneLineAndTakesItAway) {
  ASSERT_NE(terminal, nullptr);
  {
    const WorkProgress progress("reading", terminal, 0ms);
    EXPECT_THAT(read_until("reading: "), testing::StartsWith("\r\x1b[Kreading: "));
    progress.count()->begin("evaluating", "steps", 4);
    progress.count()->add_done();
    EXPECT_THAT(read_until("steps"), testing::HasSubstr("\x1b[Kevaluating: 1 of 4 steps"));
  }
  std::fputs("end", terminal);
  std::fflush(terminal);
  const std::string shown = read_until("end");
  EXPECT_THAT(shown, testing::EndsWith("\r\x1b[Kend"));
  EXPECT_EQ(shown.find('\n'), std::string::npos);
}

TEST_F(WorkProgressOnTerminal, ShowsNothingOfWhatIsQuick) {
  ASSERT_NE(terminal, nullptr);
  { const WorkProgress progress("reading", terminal); }
  std::fputs("end", terminal);
  std::fflush(terminal);
  EXPECT_EQ(read_until("end"), "end");
}

} // namespace
} // namespace dyncal::inline programs
