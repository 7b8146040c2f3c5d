#include "services/security/x509_making.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include <fmt/core.h>
#include <openssl/bn.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

namespace dyncal::inline security {
namespace {

constexpr int smallest_rsa_bits = 2048;
constexpr long version_3 = 2;   // of a certificate, as X.509 counts
constexpr long crl_version = 1; // 2
constexpr unsigned high_bit = 0x80;

template <class Number>
Number random_number() {
  Number number{};
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes, as OpenSSL takes them
  RAND_bytes(reinterpret_cast<unsigned char*>(&number), sizeof number);
  return number;
}

void add(X509_NAME* name, const char* part, const std::string& text) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes, as OpenSSL takes them
  const auto* bytes = reinterpret_cast<const unsigned char*>(text.c_str());
  X509_NAME_add_entry_by_txt(name, part, MBSTRING_UTF8, bytes, -1, -1, 0);
}

// 1, so that it is positive and as long as any other, and the beginning of the digest.
using SerialNumber = std::array<unsigned char, 17>;

void set_serial_number(X509& certificate) {
  SerialNumber number{1};
  std::copy_n(digest_of(*X509_get_subject_name(&certificate)).begin(), number.size() - 1,
              number.begin() + 1);
  BIGNUM* integer = BN_bin2bn(number.data(), number.size(), nullptr);
  BN_to_ASN1_INTEGER(integer, X509_get_serialNumber(&certificate));
  BN_free(integer);
}

void add_extension(X509& certificate, X509& issuer, int kind, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, &issuer, &certificate, nullptr, nullptr, 0);
  X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, &context, kind, value);
  X509_add_ext(&certificate, extension, -1);
  X509_EXTENSION_free(extension);
}

OpenSslPointer<X509> begin_certificate(EVP_PKEY& key, const Validity& validity) {
  constexpr std::uint64_t positive = ~(std::uint64_t{1} << 63U);
  OpenSslPointer<X509> certificate(X509_new());
  X509_set_version(certificate.get(), version_3);
  ASN1_INTEGER_set_uint64(X509_get_serialNumber(certificate.get()),
                          random_number<std::uint64_t>() & positive);
  ASN1_TIME_set(X509_getm_notBefore(certificate.get()), validity.begin);
  ASN1_TIME_set(X509_getm_notAfter(certificate.get()), validity.end);
  X509_set_pubkey(certificate.get(), &key);
  return certificate;
}

template <class Write>
std::string text_by(const Write& write) {
  const OpenSslPointer<BIO> text(BIO_new(BIO_s_mem()));
  write(text.get());
  return written_to(text.get());
}

std::time_t utc(const ASN1_TIME* time) {
  std::tm parts{};
  return ASN1_TIME_to_tm(time, &parts) == 1 ? timegm(&parts) : 0;
}

} // namespace

OpenSslPointer<EVP_PKEY> make_private_key() {
  return OpenSslPointer<EVP_PKEY>(EVP_EC_gen("P-256"));
}

OpenSslPointer<X509> make_authority(const std::string& laboratory, EVP_PKEY& key,
                                    const Validity& validity) {
  auto certificate = begin_certificate(key, validity);
  X509_NAME* name = X509_get_subject_name(certificate.get());
  add(name, "O", laboratory);
  add(name, "OU", fmt::format("{:08x}", random_number<std::uint32_t>()));
  add(name, "CN", "authority");
  X509_set_issuer_name(certificate.get(), name);
  add_extension(*certificate, *certificate, NID_basic_constraints, "critical,CA:TRUE");
  add_extension(*certificate, *certificate, NID_key_usage,
                "critical,digitalSignature,keyCertSign,cRLSign");
  add_extension(*certificate, *certificate, NID_subject_key_identifier, "hash");
  X509_sign(certificate.get(), &key, EVP_sha256());
  return certificate;
}

OpenSslPointer<X509> make_certificate(const Applicant& applicant, EVP_PKEY& key, X509& authority,
                                      EVP_PKEY& authority_key) {
  auto certificate = begin_certificate(key, applicant.validity);
  do {
    X509_NAME* name = X509_NAME_new();
    add(name, "O", applicant.laboratory);
    add(name, "OU", fmt::format("{:08x}", random_number<std::uint32_t>()));
    add(name, "CN", applicant.name);
    X509_set_subject_name(certificate.get(), name);
    X509_NAME_free(name);
  } while (has_high_subject(*certificate) != applicant.needs_high_subject);
  set_serial_number(*certificate);
  X509_set_issuer_name(certificate.get(), X509_get_subject_name(&authority));
  add_extension(*certificate, authority, NID_basic_constraints, "critical,CA:FALSE");
  add_extension(*certificate, authority, NID_key_usage, "critical,digitalSignature,keyAgreement");
  if (X509_sign(certificate.get(), &authority_key, EVP_sha256()) == 0) {
    return nullptr;
  }
  return certificate;
}

OpenSslPointer<X509_CRL> make_revoked(const X509_CRL* revoked, const Certificates& more,
                                      X509& authority, EVP_PKEY& authority_key) {
  OpenSslPointer<X509_CRL> list(revoked != nullptr ? X509_CRL_dup(revoked) : X509_CRL_new());
  X509_CRL_set_version(list.get(), crl_version);
  X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(&authority));
  const OpenSslPointer<ASN1_TIME> now(ASN1_TIME_set(nullptr, std::time(nullptr)));
  X509_CRL_set1_lastUpdate(list.get(), now.get());
  // As long as the authority: a list that has ended would shut everybody out.
  X509_CRL_set1_nextUpdate(list.get(), X509_get0_notAfter(&authority));
  for (const auto& certificate : more) {
    X509_REVOKED* one = X509_REVOKED_new();
    X509_REVOKED_set_serialNumber(one, X509_get_serialNumber(certificate.get()));
    X509_REVOKED_set_revocationDate(one, now.get());
    X509_CRL_add0_revoked(list.get(), one);
  }
  X509_CRL_sort(list.get());
  if (X509_CRL_sign(list.get(), &authority_key, EVP_sha256()) == 0) {
    return nullptr;
  }
  return list;
}

std::string pem_text(X509& certificate) {
  return text_by([&](BIO* text) { PEM_write_bio_X509(text, &certificate); });
}

std::string pem_text(X509_CRL& revoked) {
  return text_by([&](BIO* text) { PEM_write_bio_X509_CRL(text, &revoked); });
}

std::string pem_text(EVP_PKEY& key) {
  return text_by([&](BIO* text) {
    PEM_write_bio_PKCS8PrivateKey(text, &key, nullptr, nullptr, 0, nullptr, nullptr);
  });
}

std::string subject_text(const X509& certificate) {
  return text_by([&](BIO* text) {
    X509_NAME_print_ex(text, X509_get_subject_name(&certificate), 0, XN_FLAG_RFC2253);
  });
}

std::string subject_part(const X509& certificate, int nid) {
  X509_NAME* name = X509_get_subject_name(&certificate);
  const int size = X509_NAME_get_text_by_NID(name, nid, nullptr, 0);
  std::string text(size > 0 ? static_cast<std::size_t>(size) + 1 : 1, '\0');
  X509_NAME_get_text_by_NID(name, nid, text.data(), static_cast<int>(text.size()));
  text.resize(text.size() - 1); // the zero at its end
  return text;
}

SubjectDigest digest_of(const X509_NAME& subject) {
  unsigned char* encoded = nullptr;
  const int size = i2d_X509_NAME(&subject, &encoded);
  SubjectDigest digest{};
  SHA256(encoded, size > 0 ? static_cast<std::size_t>(size) : 0, digest.data());
  OPENSSL_free(encoded);
  return digest;
}

std::optional<SubjectDigest> digest_in(const ASN1_INTEGER& serial_number) {
  SerialNumber number{};
  BIGNUM* integer = ASN1_INTEGER_to_BN(&serial_number, nullptr);
  const bool fits = BN_num_bytes(integer) == static_cast<int>(number.size()) &&
                    BN_bn2bin(integer, number.data()) > 0 && number.front() == 1;
  BN_free(integer);
  SubjectDigest digest{};
  std::copy(number.begin() + 1, number.end(), digest.begin());
  return fits ? std::optional(digest) : std::nullopt;
}

bool has_high_subject(const X509& certificate) {
  return (digest_of(*X509_get_subject_name(&certificate)).front() & high_bit) != 0;
}

Validity validity_of(const X509& certificate) {
  return {utc(X509_get0_notBefore(&certificate)), utc(X509_get0_notAfter(&certificate))};
}

bool is_usable(const EVP_PKEY* key) {
  if (EVP_PKEY_get_base_id(key) == EVP_PKEY_RSA) {
    return EVP_PKEY_get_bits(key) >= smallest_rsa_bits;
  }
  std::array<char, 64> group{};
  std::size_t size = 0;
  return EVP_PKEY_get_base_id(key) == EVP_PKEY_EC &&
         EVP_PKEY_get_group_name(key, group.data(), group.size(), &size) == 1 &&
         std::string(group.data(), size) == "prime256v1";
}

} // namespace dyncal::inline security
