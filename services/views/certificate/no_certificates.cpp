// In place of the rest of this room where libxml2 or xmlsec1 were missing when dyncal was built.
#include "services/views/certificate/certificate_file.hpp"
#include "services/views/certificate/reference_certificate.hpp"
#include "services/views/certificate/verification.hpp"

namespace dyncal::inline views {
namespace {

tl::unexpected<Error> not_in_this_build() {
  return fail(ErrorCode::bad_argument,
              "this build of dyncal has no certificates: libxml2 and xmlsec1 were missing when it "
              "was built (Debian: apt install libxml2-dev libxmlsec1-dev, then build again)");
}

} // namespace

Expected<CertificateContents> write_certificate(const CertificateFileRequest& /*request*/) {
  return not_in_this_build();
}

Expected<std::vector<VerificationFinding>> verify(const VerificationRequest& /*request*/) {
  return not_in_this_build();
}

Expected<std::string> reference_file_of(const std::filesystem::path& /*certificate*/,
                                        const std::string& /*table*/) {
  return not_in_this_build();
}

const char* to_string(Verification /*question*/) {
  return "certificate";
}

} // namespace dyncal::inline views
