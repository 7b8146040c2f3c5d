#include "drivers/tss/series_source.hpp"

#include <cstdlib>
#include <fstream>
#include <netinet/in.h>
#include <sys/socket.h>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/patience.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::drivers::tss {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

std::string wire_form(int shot, int announced = 4) {
  return R"({"protocol":"dyncal-series","version":1,"shot":)" + std::to_string(shot) +
         R"(,"nominal_rate_hz":1000,"samples":2,"values":"int16","channels":[{"name":"x"}]})" +
         "\n#1" + std::to_string(announced) + std::string("\x01\x00\x02\x00\n", 5);
}

// A device that the test writes to by hand; connections are accepted in the test's own thread.
class Device {
public:
  Device() : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)), client_(-1) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(bind(listener_.number(), generic, size), 0);
    EXPECT_EQ(listen(listener_.number(), 4), 0);
    EXPECT_EQ(getsockname(listener_.number(), generic, &size), 0);
    address_ = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
  }
  void accept() { client_ = FileDescriptor(::accept(listener_.number(), nullptr, nullptr)); }
  void send(const std::string& bytes) const {
    ::send(client_.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  void hang_up() { client_ = FileDescriptor(-1); }
  [[nodiscard]] const std::string& address() const { return address_; }

private:
  FileDescriptor listener_;
  FileDescriptor client_;
  std::string address_;
};

class SeriesSocketTest : public testing::Test {
protected:
  void SetUp() override {
    source_ = series_from_socket(device_.address(), stop_);
    connect();
  }
  void connect() {
    std::thread accepting([this] { device_.accept(); });
    EXPECT_TRUE(source_->discard_pending().has_value());
    accepting.join();
  }

  Device device_;
  StopSignal stop_;
  std::unique_ptr<SeriesSource> source_;
};

TEST_F(SeriesSocketTest, ASeriesComesWithItsShot) {
  device_.send(wire_form(3));
  const auto series = source_->next(tests::patience);
  ASSERT_TRUE(series.has_value()) << series.error().message;
  EXPECT_EQ(series->shot, 3U);
  EXPECT_THAT(series->values, testing::ElementsAre(1.0, 2.0));
}

TEST_F(SeriesSocketTest, NoSeriesIsATimeoutAndTheConnectionStays) {
  const auto none = source_->next(milliseconds(20));
  ASSERT_FALSE(none.has_value());
  EXPECT_EQ(none.error().code, ErrorCode::timeout);
  device_.send(wire_form(1));
  EXPECT_TRUE(source_->next(tests::patience).has_value());
}

TEST_F(SeriesSocketTest, WhatWaitsBeforeAShotIsDropped) {
  device_.send(wire_form(1) + wire_form(2));
  ASSERT_EQ(source_->next(tests::patience)->shot, 1U);
  ASSERT_TRUE(source_->discard_pending().has_value());
  device_.send(wire_form(3));
  EXPECT_EQ(source_->next(tests::patience)->shot, 3U);
}

TEST_F(SeriesSocketTest, ABlockOfAnotherLengthThanAnnouncedIsMalformedAndTheNextCallConnectsAnew) {
  device_.send(wire_form(1, 3));
  const auto failed = source_->next(tests::patience);
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().code, ErrorCode::malformed);
  EXPECT_THAT(failed.error().message, HasSubstr(device_.address()));
  connect();
  device_.send(wire_form(2));
  EXPECT_TRUE(source_->next(tests::patience).has_value());
}

TEST_F(SeriesSocketTest, ACablePulledInTheMiddleIsADisconnection) {
  device_.send(wire_form(1).substr(0, 130));
  device_.hang_up();
  const auto failed = source_->next(tests::patience);
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().code, ErrorCode::disconnected);
}

class SeriesFolderTest : public testing::Test {
protected:
  void write(const std::string& name, int shot) const {
    std::ofstream(folder_ / "part")
        << "# nominal_rate_hz = 1000\n# shot = " << shot << "\nx\n1\n2\n";
    std::filesystem::rename(folder_ / "part", folder_ / name);
  }

  tests::TemporaryFolder temporary_;
  std::filesystem::path folder_ = temporary_.path();
  StopSignal stop_;
};

TEST_F(SeriesFolderTest, OnlyFilesThatAppearAfterwardsAreSeries) {
  write("1.csv", 1);
  const auto source = series_from_folder(folder_, stop_);
  ASSERT_TRUE(source->discard_pending().has_value());
  EXPECT_EQ(source->next(milliseconds(1)).error().code, ErrorCode::timeout);
  write("2.csv", 2);
  EXPECT_EQ(source->next(tests::patience)->shot, 2U);
  EXPECT_EQ(source->next(milliseconds(1)).error().code, ErrorCode::timeout);
}

TEST_F(SeriesFolderTest, AFolderThatIsNotThereIsNamed) {
  const auto source = series_from_folder(folder_ / "none", stop_);
  const auto failed = source->discard_pending();
  ASSERT_FALSE(failed.has_value());
  EXPECT_EQ(failed.error().code, ErrorCode::not_found);
  EXPECT_THAT(failed.error().message, HasSubstr("none"));
}

} // namespace
} // namespace dyncal::drivers::tss
