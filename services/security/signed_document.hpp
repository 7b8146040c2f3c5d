// Texts signed by the authority of a laboratory, as S/MIME files of DDS Security (multipart/signed,
// PKCS #7). Any thread.
#pragma once

#include <filesystem>
#include <string>

#include "services/base/error.hpp"
#include "services/security/pem_file.hpp"

namespace dyncal::inline security {

// Fails (bad_argument) where the key is not the certificate's.
[[nodiscard]] Expected<std::string> sign_document(const std::string& text, X509& authority,
                                                  EVP_PKEY& key);

// The text of a signed file. Fails (bad_file) where it is none, or `authority` has not signed it.
[[nodiscard]] Expected<std::string> read_signed_document(const std::filesystem::path& path,
                                                         X509& authority);

} // namespace dyncal::inline security
