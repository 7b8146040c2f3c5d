// VXI-11 against an instrument of the test's own that speaks it over ONC RPC on this host.
#include <chrono>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/link/scpi_connection.hpp"
#include "drivers/link/scpi_transport.hpp"
#include "tests/patience.hpp"
#include "tests/unit/drivers/link/vxi11_server.hpp"

namespace dyncal::drivers {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class Vxi11TransportTest : public testing::Test {
protected:
  void SetUp() override {
    if (!server_.open()) {
      GTEST_SKIP() << "SKIPPED: port 111 (rpcbind, portmapper) is not to be had on this host: it "
                      "is taken, or needs root";
    }
  }

  std::string block_ = std::string(700'000, 'x');
  Vxi11Server server_{[this](const std::string& command) -> std::string {
    if (command == "*IDN?") {
      return "RIGOL TECHNOLOGIES,MSO5072,MS5A,00.01.03\n";
    }
    if (command == ":WAVeform:DATA?") {
      return "#9" + std::string(3, '0') + std::to_string(block_.size()) + block_ + "\n";
    }
    return command == ":SYSTem:ERRor?" ? "0,\"No error\"\n" : "";
  }};
  StopSignal stop_;
};

TEST_F(Vxi11TransportTest, AsksAndIsAnswered) {
  {
    auto transport = connect_scpi_transport("vxi11:127.0.0.1", tests::patience, stop_);
    ASSERT_TRUE(transport.has_value()) << transport.error().message;
    EXPECT_EQ(server_.links, 1);
    ASSERT_TRUE((*transport)->send("*IDN?\n", tests::patience).has_value());
    const auto line = (*transport)->read_line(200, tests::patience);
    ASSERT_TRUE(line.has_value()) << line.error().message;
    EXPECT_EQ(*line, "RIGOL TECHNOLOGIES,MSO5072,MS5A,00.01.03");
    EXPECT_FALSE((*transport)->has_unread());
  }
  EXPECT_EQ(server_.links, 0);
}

TEST_F(Vxi11TransportTest, ABlockMayComeInPiecesAndHoldAnyByte) {
  for (std::size_t i = 0; i < block_.size(); ++i) {
    block_[i] = static_cast<char>(i % 251); // line ends too
  }
  auto connection =
      ScpiConnection::connect("oscilloscope", "vxi11:127.0.0.1", tests::patience, stop_);
  ASSERT_TRUE(connection.has_value()) << connection.error().message;
  const auto block = connection->query_block(":WAVeform:DATA?", 1'000'000);
  ASSERT_TRUE(block.has_value()) << block.error().message;
  EXPECT_EQ(std::string(block->begin(), block->end()), block_);
  EXPECT_GT(server_.reads, 6);
}

TEST_F(Vxi11TransportTest, NoAnswerIsATimeoutThatNamesTheInstrument) {
  auto transport = connect_scpi_transport("vxi11:127.0.0.1/inst0", tests::patience, stop_);
  ASSERT_TRUE(transport.has_value());
  ASSERT_TRUE((*transport)->send(":NOTHing?\n", 500ms).has_value());
  const auto line = (*transport)->read_line(200, 500ms);
  ASSERT_FALSE(line.has_value());
  EXPECT_EQ(line.error().code, ErrorCode::timeout);
  EXPECT_THAT(line.error().message, HasSubstr("vxi11:127.0.0.1"));
}

TEST(Vxi11Address, ThatIsNoneIsRefused) {
  EXPECT_EQ(connect_vxi11_transport("vxi11:", 100ms).error().code, ErrorCode::malformed);
  EXPECT_EQ(connect_vxi11_transport("vxi11:/inst0", 100ms).error().code, ErrorCode::malformed);
}

} // namespace
} // namespace dyncal::drivers
