// A PostgreSQL server of a test's own: in a temporary folder, on a socket in it, run by an
// unprivileged user (the server refuses root). It ends with the object.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace dyncal::tests {

class PostgresServer {
public:
  // Nothing, with the reason in `missing`, where the server cannot be started.
  [[nodiscard]] static std::unique_ptr<PostgresServer> start(std::string& missing);
  ~PostgresServer();
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  // A database that is empty.
  [[nodiscard]] std::string fresh_place();

private:
  PostgresServer(std::filesystem::path programs, std::filesystem::path folder);
  // Whether a program of the server ended well.
  [[nodiscard]] bool run(const std::string& program, const std::string& arguments) const;

  std::filesystem::path programs_;
  std::filesystem::path folder_;
  int databases_ = 0;
};

} // namespace dyncal::tests
