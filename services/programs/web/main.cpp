// dyncal-web: serves a page that shows what the benches of a laboratory do.
#include <malloc.h>

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "services/bus/host_network.hpp"
#include "services/daemon/program/child_process.hpp"
#include "services/daemon/program/daemon.hpp"
#include "services/daemon/program/options.hpp"
#include "services/programs/web/web_service.hpp"

namespace dyncal::inline programs {
namespace {

// Of glibc, which gives one to every thread that asks while others are busy, up to eight a core:
// with 75 threads what was freed in 16 of them made 63 MB of what in one was 51.
constexpr int malloc_arenas = 2;

struct WebProgram {
  std::string listen = "127.0.0.1:8080";
  web::WebOptions web;
  std::string tls_certificate;
  std::string tls_key;
};

// Where the guide is installed beside the program; empty if it is not.
std::string installed_guide() {
  const auto folder = program_folder().parent_path() / "share" / "doc" / "dyncal" / "guide";
  return std::filesystem::exists(folder / "index.html") ? folder.string() : "";
}

void add_options(CLI::App& app, WebProgram& program) {
  add_default(app, "--listen", program.listen,
              "where the page is served; other than loopback: in networks that you trust, or "
              "over TLS");
  app.add_option(
         "--tls-certificate", program.tls_certificate,
         "certificate (PEM, with those between it and the authority) to serve https:// with")
      ->envname("DYNCAL_TLS_CERTIFICATE");
  app.add_option("--tls-key", program.tls_key, "its key (PEM), which others cannot read")
      ->envname("DYNCAL_TLS_KEY");
  app.add_option("--own-name", program.web.door.own_names,
                 "name of this computer that browsers may use (repeatable; its host name, "
                 "localhost and addresses are known)");
  app.add_option("--runs", program.web.runs_folder, "folder of all runs, for downloads")
      ->envname("DYNCAL_RUNS");
  app.add_option("--store", program.web.store,
                 "file or postgresql://... of all results, for the history of a sensor, or none "
                 "(default: dyncal.sqlite in the folder of all runs)")
      ->envname("DYNCAL_STORE");
  app.add_option("--token-file", program.web.token_file,
                 "file with the secrets that visitors need to act, or to watch; without one "
                 "everybody watches, and nobody acts")
      ->envname("DYNCAL_TOKEN_FILE");
  app.add_option("--benches", program.web.benches_folder,
                 "folder of bench files that a run may be started with (needs --token-file)");
  app.add_option("--run-security", program.web.run_security,
                 "folder of an operator ('dyncal security issue') for the runs that are started "
                 "here, where --security is given: its benches are those that can be run")
      ->envname("DYNCAL_RUN_SECURITY");
  app.add_option("--guide", program.web.door.guide_folder,
                 "folder of the guide's pages (default: as it is installed with this program)");
  add_default(app, "--javascript", program.web.door.javascript_folder,
              "folder of the JavaScript libraries of this computer");
}

Expected<void> serve(WebProgram& program, Daemon& daemon) {
  const auto listen = drivers::parse_address(program.listen);
  if (!listen) {
    return fail(ErrorCode::bad_argument,
                "--listen " + program.listen + " is not ADDRESS:PORT, such as 127.0.0.1:8080");
  }
  program.web.door.listen = *listen;
  if (program.tls_certificate.empty() != program.tls_key.empty()) {
    return fail(ErrorCode::bad_argument,
                "--tls-certificate and --tls-key belong together: one of them is missing");
  }
  if (!program.tls_certificate.empty()) {
    DYNCAL_TRY(program.web.door.certificate,
               web::TlsCertificate::read(program.tls_certificate, program.tls_key));
  }
  program.web.door.own_names.push_back(bus::host_name());
  if (program.web.door.guide_folder.empty()) {
    program.web.door.guide_folder = installed_guide();
  }
  DYNCAL_TRY(auto service, web::WebService::create(daemon, program.web));
  return service->serve();
}

} // namespace
} // namespace dyncal::inline programs

int main(int argc, char** argv) { // NOLINT(bugprone-exception-escape): ends the program
  using namespace dyncal;
  mallopt(M_ARENA_MAX, malloc_arenas);
  WebProgram program;
  return run_daemon(argc, argv,
                    {.name = "dyncal-web",
                     .description =
                         "Serves a page that shows what the benches of a laboratory do: state, "
                         "signals, results, history.",
                     .add_options = [&](CLI::App& app) { add_options(app, program); },
                     .serve = [&](Daemon& daemon) { return serve(program, daemon); }});
}
