#include "services/security/signed_document.hpp"

#include <fmt/core.h>
#include <openssl/err.h>
#include <openssl/pem.h>

#include "services/base/whole_file.hpp"

namespace dyncal::inline security {
namespace {

constexpr std::uintmax_t max_document_bytes = 1U << 20U;

} // namespace

Expected<std::string> sign_document(const std::string& text, X509& authority, EVP_PKEY& key) {
  constexpr int flags = PKCS7_TEXT | PKCS7_DETACHED | PKCS7_STREAM;
  const OpenSslPointer<BIO> reader = reader_of(text);
  const OpenSslPointer<PKCS7> message(PKCS7_sign(&authority, &key, nullptr, reader.get(), flags));
  const OpenSslPointer<BIO> file(BIO_new(BIO_s_mem()));
  if (!message || SMIME_write_PKCS7(file.get(), message.get(), reader.get(), flags) != 1) {
    ERR_clear_error();
    return fail(ErrorCode::bad_argument,
                "the authority's key does not sign: is it that of its certificate?");
  }
  return written_to(file.get());
}

Expected<std::string> read_signed_document(const std::filesystem::path& path, X509& authority) {
  DYNCAL_TRY(const auto bytes, read_whole_file(path, max_document_bytes));
  const OpenSslPointer<BIO> reader = reader_of(bytes);
  BIO* content = nullptr;
  const OpenSslPointer<PKCS7> message(SMIME_read_PKCS7(reader.get(), &content));
  const OpenSslPointer<BIO> owned_content(content);
  const OpenSslPointer<BIO> text(BIO_new(BIO_s_mem()));
  STACK_OF(X509)* signers = sk_X509_new_null();
  sk_X509_push(signers, &authority);
  // That the authority is to be trusted is what its file says.
  const bool signed_by_it =
      message != nullptr && PKCS7_verify(message.get(), signers, nullptr, content, text.get(),
                                         PKCS7_TEXT | PKCS7_NOVERIFY | PKCS7_NOINTERN) == 1;
  sk_X509_free(signers);
  ERR_clear_error();
  if (!signed_by_it) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: is not signed by the authority of ca.pem; issue it again by "
                            "'dyncal security issue'",
                            path.string()));
  }
  return written_to(text.get());
}

} // namespace dyncal::inline security
