// What Fast DDS 2.9 is given of a datagram from the network: RTPS that it takes without harm.
//
// Two of its faults end or block a program when packets are lost, and no setting avoids them. A
// sample in fragments whose key is known from its first one is filed under its instance before it
// is whole; where it never becomes whole (its writer no longer has it) it is freed and stays filed,
// and the next take() never returns. A GAP that lists single samples leaves their fragments where
// they are, and hands them out as whole. So here
//   DATA_FRAG  loses its key hash: Fast DDS then takes the key from the sample once it is whole
//   GAP        becomes one GAP for each run of samples, without a list
//
// A sample in fragments is filed by the stamp of the fragment that comes first (sample_stamps.hpp).
// So a fragment without a stamp gets that of its sample, and is left out while the first fragment
// has not come: the writer sends both again.
//
// Where a reader starts over, it may take no notice (acknack_counts.hpp). So
//   ACKNACK    of that kind becomes one for sample 0 with a new count
//
// It visits each number of a range, however long that is (reader_progress.hpp). So
//   GAP, HEARTBEAT  move a reader on in pieces
//
// What would crash it, make it allocate what a packet asks for or keep it busy is dropped: a
// message whose lengths do not agree, statistics of Fast DDS itself (submessage 0x80, not used
// here), fragments outside of their sample, samples of more than max_sample_bytes.
//
// DDSI-RTPS 2.2, chapters 8.3 and 9.4. One thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "services/bus/fastdds/screen/acknack_counts.hpp"
#include "services/bus/fastdds/screen/reader_progress.hpp"
#include "services/bus/fastdds/screen/sample_stamps.hpp"

namespace dyncal::bus {

class RtpsScreen {
public:
  // Those of the participant, which outlive the object.
  RtpsScreen(SampleStamps& stamps, ReaderProgress& progress)
      : stamps_(&stamps), progress_(&progress) {}

  // The message to hand on, valid until the next call; empty if there is none. Up to
  // readable_bytes_behind bytes behind it may be read: Fast DDS copies the last fragment of a
  // sample in the length that the first one said.
  [[nodiscard]] std::span<const unsigned char> pass(std::span<const unsigned char> datagram);

  // Whether the datagram of the last call was dropped for what is in it, and not only because
  // nobody needs it.
  [[nodiscard]] bool refused() const { return refused_; }

  static constexpr std::size_t readable_bytes_behind = 1U << 16;

private:
  void begin(std::span<const unsigned char> header);
  void append(std::span<const unsigned char> bytes);
  unsigned char* append_submessage(unsigned char id, unsigned char flags,
                                   std::span<const unsigned char> body);
  void append_gap(std::span<const unsigned char> entities, std::int64_t first, std::int64_t end);
  bool pass_submessage(unsigned char id, unsigned char flags, std::span<const unsigned char> body);
  bool pass_heartbeat(unsigned char flags, std::span<const unsigned char> body);
  bool pass_acknack(unsigned char flags, std::span<const unsigned char> body);
  void append_beginning(unsigned char flags, std::span<const unsigned char> entities,
                        std::uint32_t count);
  bool pass_data(unsigned char flags, std::span<const unsigned char> body);
  bool pass_fragments(unsigned char flags, std::span<const unsigned char> body);
  bool pass_gap(unsigned char flags, std::span<const unsigned char> body);
  bool pass_timestamp(unsigned char flags, std::span<const unsigned char> body);
  void append_stamp(const RtpsStamp& stamp);
  [[nodiscard]] std::span<const unsigned char> source() const;
  [[nodiscard]] SampleStamps::Sample sample_of(unsigned char flags,
                                               std::span<const unsigned char> body) const;

  SampleStamps* stamps_;
  ReaderProgress* progress_;
  std::optional<RtpsStamp> stamp_; // of what follows in the message
  std::vector<unsigned char> buffer_;
  std::size_t used_ = 0;
  bool refused_ = false;
  AcknackCounts acknack_counts_;
};

} // namespace dyncal::bus
