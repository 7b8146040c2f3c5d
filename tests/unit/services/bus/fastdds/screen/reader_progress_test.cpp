#include "services/bus/fastdds/screen/reader_progress.hpp"

#include <gtest/gtest.h>

#include "tests/unit/services/bus/fastdds/screen/rtps_bytes.hpp"

namespace dyncal::bus {
namespace {

using namespace tests_of_rtps;
using namespace std::chrono_literals;
namespace format = rtps_format;

constexpr std::int64_t many = 10'000'000;
const Bytes one_reader{0, 0, 1, 7};
const Bytes another_reader{0, 0, 2, 7};
const Bytes all_readers{0, 0, 0, 0};
const Bytes writer{0, 0, 1, 2};

class ReaderProgressTest : public testing::Test {
protected:
  ReaderProgress progress_;
  ReaderProgress::Instant now_ = std::chrono::steady_clock::now();

  void acknack(const Bytes& reader, std::int64_t next) {
    progress_.sent(header() + submessage(format::info_destination, 1, participant) +
                       submessage(format::acknack, 1,
                                  reader + writer + sequence(static_cast<std::uint64_t>(next)) +
                                      u32(0) + u32(1)),
                   now_);
  }
  ReaderProgress::Range gap(const Bytes& reader, std::int64_t first, std::int64_t end) {
    return progress_.of_gap(participant, reader + writer, {first, end}, now_);
  }
  std::int64_t heartbeat(const Bytes& reader, std::int64_t first) {
    return progress_.heartbeat_begin(participant, reader + writer, first, now_);
  }
};

TEST_F(ReaderProgressTest, AReaderIsToldOfALongHoleInPieces) {
  acknack(one_reader, 2);
  std::int64_t next = 2;
  int pieces = 0;
  while (next < many) {
    const ReaderProgress::Range piece = gap(one_reader, 2, many);
    EXPECT_EQ(piece.first, next);
    ASSERT_GE(piece.end - piece.first, std::min(ReaderProgress::window, many - next));
    EXPECT_LE(piece.end - piece.first, ReaderProgress::max_visits / ReaderProgress::visits_in_gap);
    next = piece.end;
    acknack(one_reader, next);
    now_ += 10ms;
    ++pieces;
  }
  EXPECT_EQ(next, many);
  EXPECT_LT(pieces, 1500) << "within 15 s";
}

TEST_F(ReaderProgressTest, ForgedHolesCostNoMoreThanTheAllowance) {
  acknack(one_reader, 5);
  std::int64_t visited = 0;
  constexpr int packets = 1000;
  for (int i = 0; i < packets; ++i) {
    const ReaderProgress::Range piece = gap(all_readers, 1, (std::int64_t{1} << 40) + i);
    visited += piece.end - piece.first;
  }
  EXPECT_LE(visited, ReaderProgress::max_visits + packets * ReaderProgress::window);
}

TEST_F(ReaderProgressTest, NoPieceFollowsOneThatTheReaderHasNotAcknowledged) {
  acknack(one_reader, 5);
  static_cast<void>(heartbeat(one_reader, many)); // as one that the library passes over
  const ReaderProgress::Range piece = gap(one_reader, 5, many);
  EXPECT_EQ(piece.first, 5);
  EXPECT_GE(piece.end, 5 + ReaderProgress::window);
  EXPECT_EQ(gap(one_reader, 5, many).end, 5 + ReaderProgress::window) << "it would be kept";
}

TEST_F(ReaderProgressTest, WhatIsFarBehindWhatAReaderLacksIsNotKept) {
  acknack(one_reader, 5);
  EXPECT_EQ(gap(one_reader, 7, many).end, 5 + ReaderProgress::window);
  const ReaderProgress::Range beyond = gap(one_reader, many, 2 * many);
  EXPECT_LE(beyond.end, beyond.first);
  const ReaderProgress::Range old = gap(one_reader, 1, 5);
  EXPECT_LE(old.end, old.first) << "it has that";
}

TEST_F(ReaderProgressTest, LittleIsToldOfWhereNoReaderIsKnown) {
  EXPECT_EQ(gap(all_readers, 3, many).end, 3 + ReaderProgress::window);
  acknack(one_reader, many);
  now_ += ReaderProgress::lives;
  EXPECT_EQ(gap(all_readers, 3, many).end, 3 + ReaderProgress::window) << "it may be gone";
}

TEST_F(ReaderProgressTest, AHoleIsForTheReaderThatLacksMost) {
  acknack(one_reader, 2 * many);
  acknack(another_reader, 3);
  EXPECT_EQ(gap(all_readers, 1, many).first, 3);
  const ReaderProgress::Range of_first = gap(one_reader, 1, many);
  EXPECT_LE(of_first.end, of_first.first);
}

TEST_F(ReaderProgressTest, ShortStepsAreLeftAsTheyAre) {
  acknack(one_reader, 100);
  for (std::int64_t first = 100; first < 100'000; first += 500) {
    EXPECT_EQ(heartbeat(one_reader, first), first);
    const ReaderProgress::Range one = gap(one_reader, first, first + 300);
    EXPECT_EQ(one.first, first);
    EXPECT_EQ(one.end, first + 300);
    acknack(one_reader, first + 300);
  }
}

TEST_F(ReaderProgressTest, AHeartbeatMovesALateReaderOnInPieces) {
  std::int64_t begin = 0;
  int heartbeats = 0;
  while (begin < many) {
    const std::int64_t next = heartbeat(all_readers, many);
    ASSERT_GE(next - begin, std::min(ReaderProgress::window, many - begin));
    EXPECT_LE(next - begin, ReaderProgress::max_visits + 1);
    begin = next;
    acknack(one_reader, begin);
    now_ += 10ms;
    ++heartbeats;
  }
  EXPECT_EQ(begin, many);
  EXPECT_LT(heartbeats, 500) << "within 5 s";
  EXPECT_EQ(heartbeat(all_readers, many + 7), many + 7);
}

TEST_F(ReaderProgressTest, KnowsABoundedNumberOfReaders) {
  for (std::uint32_t id = 1; id <= ReaderProgress::max_readers + 5; ++id) {
    acknack(u32(id), many);
  }
  EXPECT_EQ(gap(u32(1), 1, many).end, 1 + ReaderProgress::window) << "all were forgotten";
  const ReaderProgress::Range of_newest = gap(u32(ReaderProgress::max_readers + 5), 1, many);
  EXPECT_LE(of_newest.end, of_newest.first);
}

TEST_F(ReaderProgressTest, PassesOverWhatIsTooShort) {
  for (std::size_t bytes = 0; bytes < 24; ++bytes) {
    progress_.sent(header() + submessage(format::acknack, 1, Bytes(bytes, 0xff)), now_);
    progress_.sent(Bytes(bytes, 0xff), now_);
  }
  EXPECT_EQ(gap(all_readers, 1, 9).end, 9);
}

} // namespace
} // namespace dyncal::bus
