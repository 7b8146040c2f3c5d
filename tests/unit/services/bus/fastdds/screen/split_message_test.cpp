#include "services/bus/fastdds/screen/split_message.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::bus {
namespace {

using Datagram = std::vector<unsigned char>;
using testing::ElementsAre;

constexpr unsigned char info_timestamp = 0x09;
constexpr unsigned char info_destination = 0x0e;
constexpr unsigned char data = 0x15;
constexpr unsigned char encrypted = 0x30;
constexpr unsigned char encrypted_prefix = 0x31;
constexpr unsigned char encrypted_postfix = 0x32;
constexpr unsigned char encrypted_message = 0x33;

Datagram header() {
  Datagram bytes{'R', 'T', 'P', 'S', 2, 3, 1, 15};
  bytes.resize(20, 7);
  return bytes;
}
Datagram submessage(unsigned char id, std::size_t body, unsigned char fill = 0) {
  Datagram bytes{id, 1, static_cast<unsigned char>(body), static_cast<unsigned char>(body >> 8U)};
  bytes.resize(4 + body, fill);
  return bytes;
}
Datagram joined(const std::vector<Datagram>& all) {
  Datagram bytes;
  for (const Datagram& one : all) {
    bytes.insert(bytes.end(), one.begin(), one.end());
  }
  return bytes;
}

TEST(SplitMessage, GivesEachPartWhatCountsForIt) {
  const Datagram to = submessage(info_destination, 12, 5);
  const Datagram first_stamp = submessage(info_timestamp, 8, 1);
  const Datagram second_stamp = submessage(info_timestamp, 8, 2);
  const Datagram first = submessage(data, 400, 1);
  const Datagram second = submessage(data, 400, 2);
  const Datagram third = submessage(data, 40, 3);
  EXPECT_THAT(
      split_message(joined({header(), to, first_stamp, first, second_stamp, second, third}), 660),
      ElementsAre(joined({header(), to, first_stamp, first, second_stamp}),
                  joined({header(), second_stamp, to, second, third})));
}

TEST(SplitMessage, EndsEachPartAsFastDdsEndsItsMessages) {
  const Datagram end = submessage(0x80, 56);
  const Datagram first = submessage(data, 400, 1);
  const Datagram longer = submessage(data, 2000, 0x80);
  const auto parts = split_message(joined({header(), first, first, longer, end}), 600);
  EXPECT_THAT(parts, ElementsAre(joined({header(), first, end}), joined({header(), first, end}),
                                 joined({header(), longer, end})));
  for (const Datagram& part : parts) { // where the transport looks for it
    EXPECT_EQ(part.at(part.size() - 60), 0x80);
    EXPECT_EQ(part.at(part.size() - 58), 56);
  }
}

TEST(SplitMessage, KeepsTogetherWhatIsEncryptedAsOne) {
  const auto sample = [](unsigned char fill) {
    return joined({submessage(encrypted_prefix, 20, fill), submessage(encrypted, 300, fill),
                   submessage(encrypted_postfix, 20, fill)});
  };
  EXPECT_THAT(split_message(joined({header(), sample(1), sample(2), sample(3)}), 860),
              ElementsAre(joined({header(), sample(1), sample(2)}), joined({header(), sample(3)})));
}

TEST(SplitMessage, LeavesWholeWhatCannotBeSplit) {
  const Datagram longer = joined({header(), submessage(data, 2000)});
  EXPECT_THAT(split_message(longer, 600), ElementsAre(longer));
  const Datagram protected_message =
      joined({header(), submessage(encrypted_message, 20), submessage(encrypted, 2000)});
  EXPECT_THAT(split_message(protected_message, 600), ElementsAre(protected_message));
  Datagram broken = joined({header(), submessage(data, 400), submessage(data, 400)});
  broken.resize(broken.size() - 8);
  EXPECT_THAT(split_message(broken, 600), ElementsAre(broken));
  const Datagram endless = joined({header(), submessage(data, 400),
                                   submessage(encrypted_prefix, 20), submessage(encrypted, 400)});
  EXPECT_THAT(split_message(endless, 600), ElementsAre(endless));
  EXPECT_THAT(split_message(header(), 600), ElementsAre(header()));
}

} // namespace
} // namespace dyncal::bus
