#include "services/security/revoked_participants.hpp"

#include <algorithm>

#include <fmt/core.h>
#include <openssl/err.h>

#include "services/base/whole_file.hpp"
#include "services/security/identity_folder.hpp"
#include "services/security/pem_file.hpp"
#include "services/security/x509_making.hpp"

namespace dyncal::inline security {
namespace {

constexpr std::chrono::seconds look_interval{2};
constexpr std::size_t max_list_bytes = 1U << 20U;

// The first bit is 1, and 47 bits of the digest follow.
GuidStart guid_start_by(const unsigned char* digest) {
  GuidStart start{};
  unsigned before = 1;
  for (std::size_t i = 0; i < start.size(); ++i) {
    start[i] = static_cast<unsigned char>((before << 7U) | (digest[i] >> 1U));
    before = digest[i];
  }
  return start;
}

std::set<GuidStart> guid_starts_in(X509_CRL& revoked) {
  std::set<GuidStart> starts;
  STACK_OF(X509_REVOKED)* all = X509_CRL_get_REVOKED(&revoked);
  for (int i = 0; i < sk_X509_REVOKED_num(all); ++i) {
    if (const auto digest =
            digest_in(*X509_REVOKED_get0_serialNumber(sk_X509_REVOKED_value(all, i)))) {
      starts.insert(guid_start_by(digest->data()));
    }
  }
  return starts;
}

} // namespace

GuidStart guid_start_of(const X509_NAME& subject) {
  return guid_start_by(digest_of(subject).data());
}

std::set<GuidStart> revoked_guid_starts(const std::filesystem::path& list) {
  const auto revoked = read_revoked(list);
  ERR_clear_error();
  return revoked ? guid_starts_in(**revoked) : std::set<GuidStart>();
}

std::optional<GuidStart> own_guid_start(const std::filesystem::path& folder, bus::Vendor vendor) {
  const auto own = read_certificates(security_files(folder, vendor).certificate);
  return own ? std::optional(guid_start_of(*X509_get_subject_name(own->front().get())))
             : std::nullopt;
}

bool RevokedParticipants::hold(const bus::WriterId& writer, Instant now) {
  const std::lock_guard lock(mutex_);
  if (now >= next_look_) {
    next_look_ = now + look_interval;
    look_again();
  }
  if (revoked_.empty()) {
    return false;
  }
  GuidStart start{};
  std::copy_n(writer.guid.begin(), start.size(), start.begin());
  return !writer.is_known() || revoked_.contains(start);
}

void RevokedParticipants::look_again() {
  const auto text = read_whole_file(files_.revoked, max_list_bytes).value_or("");
  if (text == last_text_) {
    return;
  }
  const bool is_news = !last_text_.empty(); // what a program begins with is none
  last_text_ = text;
  const auto revoked = read_revoked(files_.revoked);
  const auto authorities = read_certificates(files_.authority);
  const bool is_signed =
      revoked && authorities &&
      X509_CRL_verify(revoked->get(), X509_get0_pubkey(authorities->front().get())) == 1;
  ERR_clear_error();
  if (is_signed) {
    revoked_.merge(guid_starts_in(**revoked));
    if (is_news) {
      tell(**revoked);
    }
  } else {
    warn_(fmt::format("{}: is not a list that the authority of ca.pem has signed; the one before "
                      "it goes on",
                      files_.revoked.string()));
  }
}

void RevokedParticipants::tell(X509_CRL& revoked) const {
  warn_(fmt::format("{}: a new list; nothing more is taken from who has one of its {} revoked "
                    "certificates",
                    files_.revoked.string(), revoked_.size()));
  X509_REVOKED* found = nullptr;
  const auto own = read_certificates(files_.certificate);
  if (own && X509_CRL_get0_by_cert(&revoked, &found, own->front().get()) == 1) {
    warn_(fmt::format("{}: this program's own certificate is revoked, so it ends",
                      files_.certificate.string()));
    end_();
  }
}

} // namespace dyncal::inline security
