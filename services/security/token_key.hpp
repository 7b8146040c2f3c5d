// A private key that stays in a token: a smart card, an HSM, or a file of softhsm2. It is named by
// its PKCS #11 URI (RFC 7512): "pkcs11:token=lab;object=signer?pin-source=file:/root/pin".
//
// By OpenSSL's engine `pkcs11` (Debian: libengine-pkcs11-openssl), which asks the modules that
// p11-kit knows, or the one of PKCS11_MODULE_PATH. The key signs in the token and is never here;
// the PIN is read from the file of the URI, or asked for on the terminal. One thread at a time.
#pragma once

#include <memory>
#include <string>

#include <openssl/evp.h>

#include "services/base/error.hpp"

namespace dyncal::inline security {

[[nodiscard]] bool is_in_a_token(const std::string& name);

// An RSA key; holds the token open for as long as it lives. Fails (bad_file) without the engine,
// the token, the key in it or the right PIN, on a key of another kind, and on a PIN within the URI,
// which everybody here would see.
[[nodiscard]] Expected<std::shared_ptr<EVP_PKEY>> open_token_key(const std::string& uri);

} // namespace dyncal::inline security
