#include "services/bus/cyclonedds/cyclone_dds_security.hpp"

#include <dlfcn.h>

#include <array>

#include "services/bus/adapters.hpp"

namespace dyncal::bus {
namespace {

struct PlugIn {
  const char* property;
  const char* file;
  const char* function; // which it begins and ends with
};
constexpr std::array<PlugIn, 3> plug_ins{{{"auth", "libdds_security_auth.so", "authentication"},
                                          {"access", "libdds_security_ac.so", "access_control"},
                                          {"crypto", "libdds_security_crypto.so", "crypto"}}};

// Where Debian has them; else beside the library, where others install them.
std::filesystem::path path_of(const PlugIn& plug_in) {
  Dl_info library{};
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): as dladdr() takes it
  if (dladdr(reinterpret_cast<const void*>(&dds_create_participant), &library) == 0) {
    return plug_in.file;
  }
  const auto folder = std::filesystem::path(library.dli_fname).parent_path();
  std::error_code unreadable;
  const auto debian = folder / "libddsc0debian" / plug_in.file;
  return std::filesystem::exists(debian, unreadable) ? debian : folder / plug_in.file;
}

std::string file_url(const std::filesystem::path& path) {
  return "file:" + std::filesystem::absolute(path).string();
}

} // namespace

void set_cyclone_dds_security(const SecurityFiles& files, dds_qos_t& qos) {
  const auto set = [&](const std::string& name, const std::string& value) {
    dds_qset_prop(&qos, name.c_str(), value.c_str());
  };
  for (const PlugIn& plug_in : plug_ins) {
    const std::string library = std::string("dds.sec.") + plug_in.property + ".library.";
    set(library + "path", path_of(plug_in).string());
    set(library + "init", std::string("init_") + plug_in.function);
    set(library + "finalize", std::string("finalize_") + plug_in.function);
  }
  set("dds.sec.auth.identity_ca", file_url(files.authority));
  set("dds.sec.auth.identity_certificate", file_url(files.certificate));
  set("dds.sec.auth.private_key", file_url(files.private_key));
  set("org.eclipse.cyclonedds.sec.auth.crl", file_url(files.revoked));
  set("dds.sec.access.permissions_ca", file_url(files.authority));
  set("dds.sec.access.governance", file_url(files.governance));
  set("dds.sec.access.permissions", file_url(files.permissions));
}

std::optional<std::string> what_cyclone_dds_security_lacks() {
  for (const PlugIn& plug_in : plug_ins) {
    const auto path = path_of(plug_in);
    std::error_code unreadable;
    if (!std::filesystem::exists(path, unreadable)) {
      return path.string() + ": is not there, so this host's Cyclone DDS cannot be secured; "
                             "install Debian's package of it";
    }
  }
  return std::nullopt;
}

} // namespace dyncal::bus
