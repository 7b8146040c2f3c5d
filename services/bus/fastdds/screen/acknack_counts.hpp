// Which ACKNACKs Fast DDS is to take for those of a reader that starts over, and the counts of all
// as it is given them: greater with each new one of a reader to a writer, also where the reader's
// own count started over.
//
//   passed = the reader's count + how often it has started over
//
// A reader in Cyclone DDS that has forgotten a writer (its program was silent for a lease) and
// finds it again says so by an ACKNACK for sample 1 with count 0. Fast DDS, 2.9 as 3.1, expects
// sample 0, and takes no ACKNACK whose count is not greater than the one before (DDSI-RTPS 8.4.15.7
// allows that). Where it had not forgotten the reader meanwhile, it therefore sent nothing of what
// the reader lacked: not even which writers and readers it has, and the two were silent to each
// other for ever.
//
// A reader in Fast DDS goes on counting, and its first ACKNACK is for sample 0; but where a
// heartbeat of the writer comes before that, it goes without, and asks for what it lacks. The
// writer sends nothing that it holds for acknowledged. So a reader that asks for what it has
// acknowledged before starts over as well.
//
// A copy of such an ACKNACK can come at any time. A reader starts over after a silence, so it is
// believed where its pair has been silent for min_silence, and every min_interval: before that
// Fast DDS may not know the reader. Otherwise it counts as an old one, which Fast DDS passes over.
//
// Bound: max_newcomers and max_known pairs, of which all are forgotten when there are more. A pair
// is known when it has gone on; packets with a changed sender make newcomers only. Forgotten with a
// pair is how often it has started over, and so many of its ACKNACKs are left out. One thread at a
// time.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>

namespace dyncal::bus {

class AcknackCounts {
public:
  using Instant = std::chrono::steady_clock::time_point;

  static constexpr std::size_t max_newcomers = 4096;
  static constexpr std::size_t max_known = 10'000;
  static constexpr std::chrono::milliseconds min_silence{1000};
  static constexpr std::chrono::milliseconds min_interval{100};

  using Pair = std::array<unsigned char, 20>;
  // `source` is the prefix of the reader's participant, `entities` the ids of reader and writer.
  [[nodiscard]] static Pair pair(std::span<const unsigned char> source,
                                 std::span<const unsigned char> entities);

  struct Acknack {
    std::int64_t base = 0; // the reader has all before it
    bool asks = false;     // for some from there on
    std::uint32_t count = 0;
  };
  struct Passed {
    std::uint32_t count = 0;
    bool begins_anew = false;
  };
  [[nodiscard]] Passed continued(const Pair& pair, const Acknack& acknack, Instant now);
  // The count of one by which the reader starts over; nothing where that is not believed.
  [[nodiscard]] std::optional<std::uint32_t> begin_anew(const Pair& pair, Instant now);

private:
  struct Counts {
    std::uint32_t newest = 0;      // as the reader counts
    std::int64_t acknowledged = 0; // before this sample
    std::uint32_t begun_anew = 0;
    std::optional<Instant> went_on;
    std::optional<Instant> began;
  };
  using AllCounts = std::map<Pair, Counts>;

  Counts& of(const Pair& pair);

  AllCounts newcomers_;
  AllCounts known_;
};

} // namespace dyncal::bus
