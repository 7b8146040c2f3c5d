// Who is in the DDS domain of a secured program and may not talk to it: participants that announce
// themselves, which is always in clear, and show no writer and no reader, which programs do once
// they have authenticated each other.
//
// Why is known in part. Whether it is secured at all its GUID tells, which begins with 1 then (OMG
// DDS Security 1.1, 9.3.3), and so does the list of revoked certificates. Some announce their
// authority, and how they protect discovery. What the permissions allow, the protection of single
// topics, and the end of a certificate stand in no announcement.
//
// Functions: any thread. A StrangerWatch belongs to one thread.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "services/bus/bus.hpp"
#include "services/bus/discovery.hpp"

namespace dyncal::inline security {

struct Stranger {
  std::string id; // as in discovery.hpp
  std::string name;
  std::string reason{}; // that its announcement tells; empty: it does not
};

// "2 programs are here that this program may not talk to: ..."; empty where there are none.
// `revoked`: the list of revoked certificates of this program.
[[nodiscard]] std::string strangers_sentence(const std::vector<Stranger>& strangers,
                                             const std::filesystem::path& revoked);

// Subject of the authority of a folder (identity_folder.hpp), as announcements have it; empty where
// it cannot be read.
[[nodiscard]] std::string authority_of(const std::filesystem::path& folder);

// Those of whom no writer and no reader is known.
[[nodiscard]] std::vector<Stranger> without_endpoints(const bus::Discovery& discovery);

class StrangerWatch {
public:
  using Instant = std::chrono::steady_clock::time_point;
  static constexpr std::size_t max_strangers = 1000;
  // A participant that is refused may come and go with its announcements.
  static constexpr std::chrono::seconds forgotten_after{15};

  void look(const bus::Discovery& discovery, Instant now);
  // Who was seen to be one for so long. Programs that begin are, while they authenticate each
  // other.
  [[nodiscard]] std::vector<Stranger> strangers(std::chrono::nanoseconds for_at_least) const;

private:
  struct Seen {
    std::string name;
    Instant first;
    Instant last;
  };
  std::map<std::string, Seen> seen_; // by id
};

} // namespace dyncal::inline security
