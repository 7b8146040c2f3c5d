#include "services/views/certificate/signature.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <memory>
#include <utility>

#include <fmt/core.h>
#include <libxml/tree.h>
#include <openssl/err.h>
#include <openssl/x509v3.h>
#include <xmlsec/crypto.h>
#include <xmlsec/errors.h>
#include <xmlsec/keyinfo.h>
#include <xmlsec/openssl/evp.h>
#include <xmlsec/openssl/x509.h>
#include <xmlsec/templates.h>
#include <xmlsec/xmldsig.h>
#include <xmlsec/xmlsec.h>

#include "services/security/token_key.hpp"
#include "services/views/certificate/x509_certificates.hpp"

namespace dyncal::inline views {
namespace {

constexpr int min_rsa_bits = 2048;
constexpr const char* enveloped_signature = "http://www.w3.org/2000/09/xmldsig#enveloped-signature";

// Ways to write XML before it is digested, and what may sign and digest.
constexpr std::array canonical_forms{
    "http://www.w3.org/2001/10/xml-exc-c14n#",
    "http://www.w3.org/TR/2001/REC-xml-c14n-20010315",
    "http://www.w3.org/2006/12/xml-c14n11",
};
constexpr std::array signature_methods{
    "http://www.w3.org/2001/04/xmldsig-more#rsa-sha256",
    "http://www.w3.org/2001/04/xmldsig-more#rsa-sha384",
    "http://www.w3.org/2001/04/xmldsig-more#rsa-sha512",
    "http://www.w3.org/2001/04/xmldsig-more#ecdsa-sha256",
    "http://www.w3.org/2001/04/xmldsig-more#ecdsa-sha384",
    "http://www.w3.org/2001/04/xmldsig-more#ecdsa-sha512",
};
constexpr std::array digest_methods{
    "http://www.w3.org/2001/04/xmlenc#sha256",
    "http://www.w3.org/2001/04/xmldsig-more#sha384",
    "http://www.w3.org/2001/04/xmlenc#sha512",
};

// Once for the process; xmlsec says nothing by itself.
bool start_xmlsec() {
  static const bool started = [] {
    if (xmlSecInit() < 0 || xmlSecCryptoAppInit(nullptr) < 0 || xmlSecCryptoInit() < 0) {
      return false;
    }
    xmlSecErrorsDefaultCallbackEnableOutput(0);
    return true;
  }();
  return started;
}

struct FreeXmlSec {
  void operator()(xmlSecDSigCtx* context) const { xmlSecDSigCtxDestroy(context); }
  void operator()(xmlSecKey* key) const { xmlSecKeyDestroy(key); }
};
template <class T>
using XmlSecPointer = std::unique_ptr<T, FreeXmlSec>;

// A key of xmlsec with the public or private key given.
XmlSecPointer<xmlSecKey> xmlsec_key(EVP_PKEY* key) {
  EVP_PKEY_up_ref(key);
  xmlSecKeyData* data = xmlSecOpenSSLEvpKeyAdopt(key);
  XmlSecPointer<xmlSecKey> made(xmlSecKeyCreate());
  if (data == nullptr || !made || xmlSecKeySetValue(made.get(), data) < 0) {
    return nullptr;
  }
  return made;
}

// The certificates go into the signature.
bool add_certificates(xmlSecKey* key, const Certificates& certificates) {
  xmlSecKeyData* data = xmlSecKeyEnsureData(key, xmlSecOpenSSLKeyDataX509Id);
  if (data == nullptr) {
    return false;
  }
  for (const OpenSslPointer<X509>& one : certificates) {
    X509_up_ref(one.get());
    const bool is_signer = &one == &certificates.front();
    const int added = is_signer ? xmlSecOpenSSLKeyDataX509AdoptKeyCert(data, one.get())
                                : xmlSecOpenSSLKeyDataX509AdoptCert(data, one.get());
    if (added < 0) {
      return false;
    }
    if (is_signer) { // the key's certificate is not among those written
      X509_up_ref(one.get());
      if (xmlSecOpenSSLKeyDataX509AdoptCert(data, one.get()) < 0) {
        return false;
      }
    }
  }
  return true;
}

tl::unexpected<Error> not_signed(const std::string& reason) {
  return fail(ErrorCode::bad_file, "the certificate cannot be signed: " + reason);
}

// Nothing for a kind of key that no signature of a DCC is made with here.
xmlSecTransformId method_for(const EVP_PKEY* key) {
  const int kind = EVP_PKEY_get_base_id(key);
  if (kind == EVP_PKEY_RSA && EVP_PKEY_get_bits(key) >= min_rsa_bits) {
    return xmlSecTransformRsaSha256Id;
  }
  return kind == EVP_PKEY_EC ? xmlSecTransformEcdsaSha256Id : xmlSecTransformIdUnknown;
}

// An empty signature at the end of the root, which xmlsec fills.
xmlNode* add_template(XmlDocument& document, xmlSecTransformId method) {
  xmlNode* signature = xmlSecTmplSignatureCreateNsPref(
      document.get(), xmlSecTransformExclC14NId, method, nullptr,
      // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): how libxml2 spells UTF-8
      reinterpret_cast<const xmlChar*>("ds"));
  xmlAddChild(document.root().node(), signature);
  xmlNode* reference =
      xmlSecTmplSignatureAddReference(signature, xmlSecTransformSha256Id, nullptr,
                                      // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
                                      reinterpret_cast<const xmlChar*>(""), nullptr);
  xmlSecTmplReferenceAddTransform(reference, xmlSecTransformEnvelopedId);
  xmlSecTmplReferenceAddTransform(reference, xmlSecTransformExclC14NId);
  xmlNode* info = xmlSecTmplSignatureEnsureKeyInfo(signature, nullptr);
  xmlNode* data = xmlSecTmplKeyInfoAddX509Data(info);
  xmlSecTmplX509DataAddCertificate(data);
  return signature;
}

tl::unexpected<SignatureFailure> refused(SignatureProblem problem, std::string sentence) {
  return tl::unexpected(SignatureFailure{problem, std::move(sentence)});
}

tl::unexpected<SignatureFailure> not_intact(const std::string& reason) {
  return refused(SignatureProblem::not_intact, "the signature is refused: " + reason);
}

bool is_signature_element(const XmlElement& element, std::string_view name) {
  return element.is(name, signature_namespace);
}

template <class List>
bool is_one_of(const List& list, const std::string& text) {
  return std::ranges::find(list, text) != list.end();
}

// Children of a signature's element, which must be exactly these.
std::optional<std::vector<XmlElement>> exactly(const XmlElement& parent,
                                               const std::vector<std::string_view>& names) {
  std::vector<XmlElement> children = parent.children();
  if (children.size() != names.size()) {
    return std::nullopt;
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!is_signature_element(children[i], names[i])) {
      return std::nullopt;
    }
  }
  return children;
}

// Empty: the reference is to the whole document, and digests it as accepted.
std::string problem_of_reference(const XmlElement& reference) {
  if (!reference.has_attribute("URI") || !reference.attribute("URI").empty()) {
    return "it is not over the whole document";
  }
  const auto parts = exactly(reference, {"Transforms", "DigestMethod", "DigestValue"});
  const auto transforms = parts ? exactly((*parts)[0], {"Transform", "Transform"}) : std::nullopt;
  if (!transforms || (*transforms)[0].attribute("Algorithm") != enveloped_signature ||
      !is_one_of(canonical_forms, (*transforms)[1].attribute("Algorithm")) ||
      !(*transforms)[0].children().empty() || !(*transforms)[1].children().empty()) {
    return "it transforms the document before it is digested in a way that may leave parts out";
  }
  return is_one_of(digest_methods, (*parts)[1].attribute("Algorithm"))
             ? ""
             : "its digest is not SHA-256 or better";
}

// Of the accepted form? `x509_data` is where its certificates are.
std::string problem_of_form(const XmlElement& signature, std::optional<XmlElement>& x509_data) {
  const auto parts = exactly(signature, {"SignedInfo", "SignatureValue", "KeyInfo"});
  const auto info =
      parts ? exactly((*parts)[0], {"CanonicalizationMethod", "SignatureMethod", "Reference"})
            : std::nullopt;
  const auto key = parts ? exactly((*parts)[2], {"X509Data"}) : std::nullopt;
  if (!info || !key) {
    return "it has other parts than one reference, one value and X.509 certificates";
  }
  if (!is_one_of(canonical_forms, (*info)[0].attribute("Algorithm")) ||
      !(*info)[0].children().empty() ||
      !is_one_of(signature_methods, (*info)[1].attribute("Algorithm")) ||
      !(*info)[1].children().empty()) {
    return "it is not made with RSA or ECDSA and SHA-256 or better";
  }
  const std::vector<XmlElement> certificates = (*key)[0].children();
  if (certificates.empty() || !std::ranges::all_of(certificates, [](const XmlElement& one) {
        return is_signature_element(one, "X509Certificate");
      })) {
    return "it names its key by something else than X.509 certificates";
  }
  x509_data = (*key)[0];
  return problem_of_reference((*info)[2]);
}

struct FoundSignature {
  XmlElement signature;
  Certificates certificates;
};

tl::expected<FoundSignature, SignatureFailure> find_signature(const XmlDocument& document) {
  const std::vector<XmlElement> all = document.root().descendants("Signature", signature_namespace);
  if (all.empty()) {
    return refused(SignatureProblem::not_signed, "the certificate is not signed");
  }
  const std::vector<XmlElement> of_root = document.root().children();
  if (all.size() > 1 || of_root.back().node() != all.front().node()) {
    return not_intact(all.size() > 1 ? "there is more than one"
                                     : "it is not the last element of the certificate, where a DCC "
                                       "has it");
  }
  std::optional<XmlElement> x509_data;
  if (const std::string problem = problem_of_form(all.front(), x509_data); !problem.empty()) {
    return not_intact(problem);
  }
  FoundSignature found{all.front(), certificates_in(*x509_data)};
  if (found.certificates.empty()) {
    return not_intact("a certificate in it cannot be read");
  }
  return found;
}

// With the key of this certificate and nothing else; the document is left as it was.
bool verifies(const XmlDocument& document, X509* certificate) {
  XmlDocument copy = document.copy();
  const std::vector<XmlElement> signatures =
      copy.root().descendants("Signature", signature_namespace);
  EVP_PKEY* key = X509_get0_pubkey(certificate);
  if (key == nullptr || method_for(key) == xmlSecTransformIdUnknown) {
    return false;
  }
  XmlSecPointer<xmlSecDSigCtx> context(xmlSecDSigCtxCreate(nullptr));
  XmlSecPointer<xmlSecKey> public_key = xmlsec_key(key);
  if (!context || !public_key) {
    return false;
  }
  context->signKey = public_key.release();
  context->enabledReferenceUris = xmlSecTransformUriTypeEmpty;
  const bool ran = xmlSecDSigCtxVerify(context.get(), signatures.front().node()) >= 0;
  ERR_clear_error();
  return ran && context->status == xmlSecDSigStatusSucceeded;
}

// The end of YYYY-MM-DD in UTC, for a signer's certificate may be of that day; now for anything
// else.
std::time_t instant_of(const std::string& day) {
  std::tm end{};
  end.tm_hour = 23;
  end.tm_min = 59;
  return strptime(day.c_str(), "%Y-%m-%d", &end) == nullptr ? std::time(nullptr) : timegm(&end);
}

// Empty: the chain leads to a trusted certificate.
std::string problem_of_chain(const Certificates& given, const Certificates& trusted,
                             const std::string& day) {
  const OpenSslPointer<X509_STORE> store(X509_STORE_new());
  for (const OpenSslPointer<X509>& one : trusted) {
    X509_STORE_add_cert(store.get(), one.get());
  }
  STACK_OF(X509)* others = sk_X509_new_null();
  for (const OpenSslPointer<X509>& one : given) {
    sk_X509_push(others, one.get());
  }
  const OpenSslPointer<X509_STORE_CTX> context(X509_STORE_CTX_new());
  X509_STORE_CTX_init(context.get(), store.get(), given.front().get(), others);
  X509_STORE_CTX_set_time(context.get(), 0, instant_of(day));
  X509_STORE_CTX_set_flags(context.get(), X509_V_FLAG_PARTIAL_CHAIN | X509_V_FLAG_X509_STRICT);
  const bool leads = X509_verify_cert(context.get()) == 1;
  const std::string problem =
      leads ? "" : X509_verify_cert_error_string(X509_STORE_CTX_get_error(context.get()));
  sk_X509_free(others);
  ERR_clear_error();
  return problem;
}

Expected<std::shared_ptr<EVP_PKEY>> key_of(const std::string& name) {
  if (is_in_a_token(name)) {
    return open_token_key(name);
  }
  DYNCAL_TRY(auto key, read_private_key(name));
  return std::shared_ptr<EVP_PKEY>(std::move(key));
}

} // namespace

Expected<void> sign(XmlDocument& document, const SigningKey& files) {
  if (!start_xmlsec()) {
    return not_signed("xmlsec does not start");
  }
  DYNCAL_TRY(const auto certificates, read_certificates(files.certificate));
  DYNCAL_TRY(const auto key, key_of(files.key));
  if (X509_check_private_key(certificates.front().get(), key.get()) != 1) {
    ERR_clear_error();
    return not_signed(fmt::format("the key in {} does not belong to the first certificate in {}",
                                  files.key, files.certificate.string()));
  }
  const xmlSecTransformId method = method_for(key.get());
  if (method == xmlSecTransformIdUnknown) {
    return not_signed(fmt::format("{}: the key must be RSA with {} bits or more, or of an elliptic "
                                  "curve",
                                  files.key, min_rsa_bits));
  }
  XmlSecPointer<xmlSecKey> signing_key = xmlsec_key(key.get());
  XmlSecPointer<xmlSecDSigCtx> context(xmlSecDSigCtxCreate(nullptr));
  if (!signing_key || !context || !add_certificates(signing_key.get(), certificates)) {
    return not_signed("xmlsec does not take the key");
  }
  context->signKey = signing_key.release();
  if (xmlSecDSigCtxSign(context.get(), add_template(document, method)) < 0) {
    return not_signed("xmlsec fails");
  }
  if (!verifies(document, certificates.front().get())) { // a token may give anything
    return not_signed("what the key has signed does not verify");
  }
  return {};
}

tl::expected<Signer, SignatureFailure> check_signature(const XmlDocument& document) {
  const auto found = find_signature(document);
  if (!found) {
    return tl::unexpected(found.error());
  }
  X509* signer = found->certificates.front().get();
  if (!start_xmlsec() || !verifies(document, signer)) {
    return not_intact("the document is not the one that was signed, or the signature is not by the "
                      "key of its certificate");
  }
  const bool is_rsa = EVP_PKEY_get_base_id(X509_get0_pubkey(signer)) == EVP_PKEY_RSA;
  return Signer{.subject = name_text(X509_get_subject_name(signer)),
                .issuer = name_text(X509_get_issuer_name(signer)),
                .valid_until = end_of_validity(signer),
                .algorithm = is_rsa ? "RSA" : "ECDSA"};
}

tl::expected<void, SignatureFailure> check_signer(const XmlDocument& document,
                                                  const std::filesystem::path& trusted,
                                                  const std::string& day_of_issue) {
  const auto anchors = read_certificates(trusted);
  if (!anchors) {
    return refused(SignatureProblem::not_trusted, anchors.error().message);
  }
  const auto found = find_signature(document);
  if (!found) {
    return tl::unexpected(found.error());
  }
  X509* signer = found->certificates.front().get();
  const std::string problem = problem_of_chain(found->certificates, *anchors, day_of_issue);
  if (!problem.empty()) {
    return refused(SignatureProblem::not_trusted,
                   fmt::format("the signer {} is not known by {}: {}",
                               name_text(X509_get_subject_name(signer)), trusted.string(),
                               problem));
  }
  constexpr std::uint32_t signing = KU_DIGITAL_SIGNATURE | KU_NON_REPUDIATION;
  if ((X509_get_key_usage(signer) & signing) == 0) {
    return refused(SignatureProblem::not_trusted,
                   fmt::format("the certificate of {} is not meant for signatures",
                               name_text(X509_get_subject_name(signer))));
  }
  return {};
}

} // namespace dyncal::inline views
