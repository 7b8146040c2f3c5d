#include "tests/unit/services/records/store/postgres_server.hpp"

#include <stdlib.h>
#include <unistd.h>

#include <fmt/core.h>

namespace dyncal::tests {
namespace {

namespace fs = std::filesystem;

// Of the newest server that Debian has installed.
fs::path server_programs() {
  fs::path found;
  std::error_code none;
  for (const auto& version : fs::directory_iterator("/usr/lib/postgresql", none)) {
    if (fs::exists(version.path() / "bin/initdb")) {
      found = std::max(found, version.path() / "bin");
    }
  }
  return found;
}

} // namespace

PostgresServer::PostgresServer(fs::path programs, fs::path folder)
    : programs_(std::move(programs)), folder_(std::move(folder)) {}

bool PostgresServer::run(const std::string& program, const std::string& arguments) const {
  const char* as_user =
      geteuid() == 0 ? "setpriv --reuid=nobody --regid=nogroup --clear-groups " : "";
  return std::system(fmt::format("cd {} && {}{}/{} {} >>{}/{}.out 2>&1", folder_.string(), as_user,
                                 programs_.string(), program, arguments, folder_.string(), program)
                         .c_str()) == 0;
}

std::unique_ptr<PostgresServer> PostgresServer::start(std::string& missing) {
  const fs::path programs = server_programs();
  if (programs.empty()) {
    missing = "no PostgreSQL server is installed (Debian: postgresql)";
    return nullptr;
  }
  std::string name = (fs::temp_directory_path() / "dyncal-postgres-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    missing = "no folder for a PostgreSQL server can be made";
    return nullptr;
  }
  std::unique_ptr<PostgresServer> server(new PostgresServer(programs, name));
  if (geteuid() == 0 && std::system(("chown nobody:nogroup " + name).c_str()) != 0) {
    missing = "there is no user 'nobody' to run a PostgreSQL server";
    return nullptr;
  }
  const bool runs =
      server->run("initdb", "-D data -U dyncal -A trust --no-sync --locale=C -E UTF8") &&
      server->run("pg_ctl", fmt::format("-D data -w -l server.log -o \"-k {} -c "
                                        "listen_addresses= -c fsync=off\" start",
                                        name));
  if (!runs) {
    missing = "the PostgreSQL server does not start, see " + name;
    server->folder_.clear(); // stays for whoever looks for the reason
    return nullptr;
  }
  return server;
}

PostgresServer::~PostgresServer() {
  if (folder_.empty()) {
    return;
  }
  static_cast<void>(run("pg_ctl", "-D data -m immediate -w stop"));
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

std::string PostgresServer::fresh_place() {
  const std::string name = "lab" + std::to_string(++databases_);
  static_cast<void>(run("createdb", fmt::format("-h {} -U dyncal {}", folder_.string(), name)));
  return fmt::format("host={} user=dyncal dbname={}", folder_.string(), name);
}

} // namespace dyncal::tests
