// Whose messages a secured program no longer takes, while it runs: no DDS vendor looks at the list
// of revoked certificates again once it has authenticated a participant.
//
// The list is looked at again when messages are taken, at most every 2 s. It has serial numbers
// alone. That of a certificate is made of the digest of its subject, from which the GUID of the
// participant follows (OMG DDS Security 1.1, 9.3.3), so that no certificate of another is needed.
// Who was revoked once stays so while the program runs. A list that cannot be read, or that the
// authority has not signed, is said once and left aside: the one before it goes on.
//
// Any thread.
#pragma once

#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include <openssl/x509.h>

#include "services/bus/participant_security.hpp"
#include "services/bus/writer_id.hpp"

namespace dyncal::inline security {

// How the GUIDs of all participants with a certificate begin; no two certificates have the same.
using GuidStart = std::array<unsigned char, 6>;

// Of who has this subject.
[[nodiscard]] GuidStart guid_start_of(const X509_NAME& subject);

// Of whom this list of revoked certificates names; nothing where it cannot be read.
[[nodiscard]] std::set<GuidStart> revoked_guid_starts(const std::filesystem::path& list);

// Of who has this folder (identity_folder.hpp); nothing where it has no certificate.
[[nodiscard]] std::optional<GuidStart> own_guid_start(const std::filesystem::path& folder,
                                                      bus::Vendor vendor);

class RevokedParticipants {
public:
  using Instant = std::chrono::steady_clock::time_point;
  using Warn = std::function<void(const std::string&)>;

  // `files` of the program's own folder. `end` is called once its own certificate is revoked: what
  // it goes on sending could take the place of others' messages in readers that keep one of a key.
  RevokedParticipants(bus::SecurityFiles files, Warn warn, std::function<void()> end)
      : files_(std::move(files)), warn_(std::move(warn)), end_(std::move(end)) {}

  // A writer that is not known counts as revoked as soon as anybody is: a program that was revoked
  // could end its writer before its message is taken. Others send again what matters.
  [[nodiscard]] bool hold(const bus::WriterId& writer, Instant now);

private:
  void look_again();
  void tell(X509_CRL& revoked) const;

  const bus::SecurityFiles files_;
  const Warn warn_;
  const std::function<void()> end_;
  std::mutex mutex_;
  Instant next_look_{};
  std::string last_text_;
  std::set<GuidStart> revoked_;
};

} // namespace dyncal::inline security
