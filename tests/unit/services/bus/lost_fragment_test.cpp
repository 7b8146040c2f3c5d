// A reader in Fast DDS that gets the first fragment of a message and never the rest: the writer no
// longer has it, or is gone. Packets that say so are forged here, in the name of a real writer,
// since no network loses them at will. Without RtpsScreen take() never returns, each time.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "services/bus/vendor.hpp"
#include "services/contract/topics.hpp"
#include "tests/unit/services/bus/bus_pair.hpp"

namespace dyncal::bus {
namespace {

using Bytes = std::vector<unsigned char>;

void append(Bytes& bytes, std::initializer_list<std::uint32_t> numbers) {
  for (const std::uint32_t number : numbers) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
      bytes.push_back(static_cast<unsigned char>(number >> shift));
    }
  }
}

constexpr unsigned char little_endian = 0x01;
constexpr unsigned char with_qos = 0x02;

// Of the writer with this number in its participant, to all readers.
void append_entities(Bytes& bytes, unsigned char writer) {
  const unsigned char entities[] = {0, 0, 0, 0, 0, 0, writer, 2};
  bytes.insert(bytes.end(), std::begin(entities), std::end(entities));
}

void append_header(Bytes& bytes, unsigned char id, unsigned char flags, std::size_t length) {
  bytes.insert(bytes.end(), {id, flags, static_cast<unsigned char>(length & 0xffU),
                             static_cast<unsigned char>(length >> 8U)});
}

// The first of the two fragments of message 2, with a key hash, as both vendors send it.
void append_first_fragment(Bytes& bytes, unsigned char writer) {
  constexpr std::size_t fragment_bytes = 1024;
  append_header(bytes, 0x16, little_endian | with_qos, 32 + 24 + fragment_bytes);
  append(bytes, {28U << 16U});
  append_entities(bytes, writer);
  append(bytes, {0, 2, 1, fragment_bytes << 16U | 1U, 2000});
  append(bytes, {16U << 16U | 0x70U, 1, 2, 3, 4, 1});
  bytes.resize(bytes.size() + fragment_bytes, 0x01);
}

void append_gap(Bytes& bytes, unsigned char writer, bool as_a_list) {
  append_header(bytes, 0x08, little_endian, as_a_list ? 32 : 28);
  append_entities(bytes, writer);
  append(bytes, {0, 2, 0, as_a_list ? 2U : 3U, as_a_list ? 1U : 0U});
  if (as_a_list) {
    append(bytes, {0x80000000U});
  }
}

class LostFragment : public testing::Test {
protected:
  static constexpr const char* bench = "lost-fragment";

  void SetUp() override {
    alarm(60); // a take() that does not return ends the test
    reader_ =
        reading_.reader<wire::Command>(topics::command.name, Profile::state, bench, bell_).value();
    writer_ = writing_->writer<wire::Command>(topics::command.name, Profile::state, bench).value();
    send_command(1);
    ASSERT_TRUE(wait_for_step(1));
  }
  void TearDown() override { alarm(0); }

  void send_command(std::uint32_t step) {
    wire::Command command;
    command.bench(bench);
    command.step(step);
    ASSERT_EQ(writer_->write(command), WriteOutcome::written);
  }
  bool wait_for_step(std::uint32_t step) {
    const auto deadline = std::chrono::steady_clock::now() + tests::patience;
    for (bool came = false; !came;) {
      if (std::chrono::steady_clock::now() > deadline) {
        return false;
      }
      bell_->wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(20));
      reader_->take([&](const wire::Command& command) { came |= command.step() == step; });
    }
    return true;
  }

  // The one other participant there is.
  Bytes message_of_the_writing_one() {
    const auto participants = reading_.discovered().participants;
    EXPECT_EQ(participants.size(), 1U);
    Bytes bytes{'R', 'T', 'P', 'S', 2, 2, 1, 15};
    for (std::size_t i = 0; i < 24; i += 2) {
      bytes.push_back(
          static_cast<unsigned char>(std::stoi(participants.at(0).id.substr(i, 2), nullptr, 16)));
    }
    return bytes;
  }
  static void send_to_reading_one(const Bytes& bytes) {
    const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    // The first participant's of this domain, where user data arrives (DDSI-RTPS 9.6.1.1).
    address.sin_port = htons(static_cast<std::uint16_t>(7411 + 250 * tests::own_dds_domain()));
    EXPECT_EQ(sendto(descriptor, bytes.data(), bytes.size(), 0,
                     reinterpret_cast<const sockaddr*>(&address), sizeof address),
              static_cast<ssize_t>(bytes.size()));
    close(descriptor);
  }
  // Which number the writer has is the vendor's affair.
  template <class Append>
  void forge(Append&& append_submessages) {
    for (unsigned char writer = 1; writer < 10; ++writer) {
      Bytes message = message_of_the_writing_one();
      append_submessages(message, writer);
      send_to_reading_one(message);
    }
  }

  static Participant join(bool watch_discovery) {
    ParticipantOptions options;
    options.vendor = Vendor::fast_dds;
    options.domain = tests::own_dds_domain();
    options.name = "lost fragment test";
    options.interface_name = "lo";
    options.watch_discovery = watch_discovery;
    return Participant::create(options).value();
  }

  std::shared_ptr<WakeUp> bell_ = std::make_shared<WakeUp>();
  Participant reading_ = join(true);
  std::optional<Participant> writing_ = join(false);
  std::optional<Reader<wire::Command>> reader_;
  std::optional<Writer<wire::Command>> writer_;
};

TEST_F(LostFragment, IsForgottenWhenTheWriterNoLongerHasTheMessage) {
  forge([](Bytes& message, unsigned char writer) {
    append_first_fragment(message, writer);
    append_gap(message, writer, false);
  });
  send_command(2); // given up for irrelevant, in the forged packet
  send_command(3);
  EXPECT_TRUE(wait_for_step(3));
  EXPECT_EQ(reading_.malformed_messages(), 0U);
}

TEST_F(LostFragment, IsForgottenWhenTheMessageIsOneOfAList) {
  forge([](Bytes& message, unsigned char writer) {
    append_first_fragment(message, writer);
    append_gap(message, writer, true);
  });
  send_command(2);
  send_command(3);
  EXPECT_TRUE(wait_for_step(3));
  EXPECT_EQ(reading_.malformed_messages(), 0U) << "handed out although it never came";
}

TEST_F(LostFragment, IsForgottenWhenTheWriterIsGone) {
  forge([](Bytes& message, unsigned char writer) { append_first_fragment(message, writer); });
  writer_.reset();
  writing_.reset();
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  while (reader_->matched_writers() > 0 && std::chrono::steady_clock::now() < deadline) {
    bell_->wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(20));
  }
  EXPECT_EQ(reader_->matched_writers(), 0);
  writing_ = join(false);
  writer_ = writing_->writer<wire::Command>(topics::command.name, Profile::state, bench).value();
  send_command(4);
  EXPECT_TRUE(wait_for_step(4));
  EXPECT_EQ(reading_.malformed_messages(), 0U);
}

} // namespace
} // namespace dyncal::bus
