// The counts of ACKNACKs as Fast DDS is given them: greater with each new one of a reader to a
// writer, also where the reader's own count began anew.
//
//   passed = the reader's count + how often it has begun anew
//
// A reader in Cyclone DDS that has forgotten a writer (its program was silent for a lease) and
// finds it again says so by an ACKNACK for sample 1 with count 0. Fast DDS 2.9 expects sample 0,
// and takes no ACKNACK whose count is not greater than the one before (DDSI-RTPS 8.4.15.7 allows
// that). Where it had not forgotten the reader meanwhile, it therefore sent nothing of what the
// reader lacked: not even which writers and readers it has, and the two were silent to each other
// for ever.
//
// Bound: max_pairs; when there are more, all are forgotten. Then as many ACKNACKs of a reader are
// left out as it had begun anew, which it repeats within 20 ms. One thread at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>

namespace dyncal::bus {

class AcknackCounts {
public:
  static constexpr std::size_t max_pairs = 10'000;

  using Pair = std::array<unsigned char, 20>;
  // `source` is the prefix of the reader's participant, `entities` the ids of reader and writer.
  [[nodiscard]] static Pair pair(std::span<const unsigned char> source,
                                 std::span<const unsigned char> entities);

  // Of an ACKNACK with this count.
  [[nodiscard]] std::uint32_t continued(const Pair& pair, std::uint32_t count);
  // Of one by which the reader begins anew.
  [[nodiscard]] std::uint32_t begin_anew(const Pair& pair);

private:
  struct Counts {
    std::uint32_t newest = 0; // as the reader counts
    std::uint32_t begun_anew = 0;
  };
  Counts& of(const Pair& pair);

  std::map<Pair, Counts> counts_;
};

} // namespace dyncal::bus
