// Engines are deprecated with OpenSSL 3, but Debian 12 has no provider of PKCS #11.
#define OPENSSL_SUPPRESS_DEPRECATED
#include "services/security/token_key.hpp"

#include <string_view>

#include <fmt/core.h>
#include <openssl/bn.h>
#include <openssl/engine.h>
#include <openssl/err.h>
#include <openssl/rsa.h>
#include <openssl/ui.h>

namespace dyncal::inline security {
namespace {

// Finished before the process ends: modules do not bear it when OpenSSL is cleaned up before them.
class Pkcs11Engine {
public:
  Pkcs11Engine() {
    OPENSSL_init_crypto(OPENSSL_INIT_ENGINE_DYNAMIC, nullptr);
    engine_ = ENGINE_by_id("pkcs11");
    if (engine_ != nullptr) {
      ENGINE_ctrl_cmd_string(engine_, "QUIET", nullptr, 1); // what is wrong is said once, by us
      works_ = ENGINE_init(engine_) == 1;
    }
  }
  ~Pkcs11Engine() {
    if (works_) {
      ENGINE_finish(engine_);
    }
    ENGINE_free(engine_);
  }
  Pkcs11Engine(const Pkcs11Engine&) = delete;
  Pkcs11Engine& operator=(const Pkcs11Engine&) = delete;

  [[nodiscard]] bool works() const { return works_; }
  // Null: OpenSSL's errors tell why.
  [[nodiscard]] EVP_PKEY* load(const std::string& uri) const {
    return ENGINE_load_private_key(engine_, uri.c_str(), UI_OpenSSL(), nullptr);
  }

private:
  ENGINE* engine_ = nullptr;
  bool works_ = false;
};

// xmlsec 1.2 asks an RSA key for its private exponent before it signs, and a token gives none. This
// one is never used: the token has the method that signs.
bool add_exponent(EVP_PKEY* key) {
  const std::unique_ptr<RSA, decltype(&RSA_free)> rsa(EVP_PKEY_get1_RSA(key), RSA_free);
  BIGNUM* exponent = BN_new();
  return BN_one(exponent) == 1 && RSA_set0_key(rsa.get(), nullptr, nullptr, exponent) == 1;
}

// The first error that has a text; the later ones say that something failed.
std::string reason() {
  std::string text;
  while (const unsigned long error = ERR_get_error()) {
    const char* own = ERR_reason_error_string(error);
    text = text.empty() && own != nullptr ? own : text;
  }
  return text.empty() ? "no reason is given" : text;
}

} // namespace

bool is_in_a_token(const std::string& name) {
  return name.starts_with("pkcs11:");
}

Expected<std::shared_ptr<EVP_PKEY>> open_token_key(const std::string& uri) {
  const std::string name = uri.substr(0, uri.find('?')); // without where the PIN is
  if (uri.find("pin-value") != std::string::npos) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: everybody on this computer sees a PIN that is written here; put "
                            "it into a file and name that: ?pin-source=file:/PATH",
                            name));
  }
  auto engine = std::make_shared<Pkcs11Engine>();
  if (!engine->works()) {
    ERR_clear_error();
    return fail(ErrorCode::bad_file,
                fmt::format("{}: OpenSSL has no engine for keys in tokens here: install "
                            "libengine-pkcs11-openssl",
                            name));
  }
  std::shared_ptr<EVP_PKEY> key(engine->load(uri),
                                [engine](EVP_PKEY* opened) { EVP_PKEY_free(opened); });
  if (key == nullptr) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: no token gives this private key ({}); `p11tool --list-all` or "
                            "`pkcs11-tool -O` lists keys, and a token locks itself after some "
                            "wrong PINs",
                            name, reason()));
  }
  ERR_clear_error();
  if (EVP_PKEY_get_base_id(key.get()) != EVP_PKEY_RSA || !add_exponent(key.get())) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: a key in a token must be RSA; xmlsec 1.2 does not sign by one of "
                            "an elliptic curve there",
                            name));
  }
  return key;
}

} // namespace dyncal::inline security
