// `dyncal certify RUN --lab LAB.toml`: a digital calibration certificate of a stored run.
//
// Writes certificate.xml into the run folder, NAME-certificate.xml beside NAME.json, or what
// --output says; never over an older file. Exit status 1 and one line when something is missing or
// speaks against it. Belongs to one thread.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace dyncal::inline programs {

struct CertifyCommand {
  std::filesystem::path run;
  std::filesystem::path laboratory;
  std::filesystem::path sensor;      // empty: as the run knows it
  std::vector<std::string> channels; // empty: all that respond
  std::string number;
  std::string performed;             // YYYY-MM-DD; empty: from the run
  std::filesystem::path key;         // empty: not signed
  std::filesystem::path certificate; // of the key
  std::filesystem::path schema;      // empty: the installed one
  std::filesystem::path output;      // empty: as above
  bool force = false;
};

[[nodiscard]] int run_certify(const CertifyCommand& command);

} // namespace dyncal::inline programs
