// The documents that were issued: certificates (DCC) and reports (PDF), with their numbers.
//
// A number belongs to one calibration: to one result, of which there may be one document of each
// kind. What is issued again gets a number of its own and names the one that it replaces; that
// one was issued before, and is replaced once. The SHA-256 tells whether a file is such a document.
//
// Fails (bad_argument) where a number cannot be given, (bad_file) as databases do. Belongs to one
// thread; programs that issue at once wait for each other.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/base/acting_person.hpp"
#include "services/base/error.hpp"
#include "services/records/store/database.hpp"

namespace dyncal::inline records {

struct IssuedDocument {
  std::string sha256; // of the file
  std::string number;
  std::string kind;         // "DCC", "PDF"
  std::string identifier{}; // UUID of a DCC
  std::string replaces;     // a number; empty: none
  std::string issued_utc{};
  std::string result_sha256;
  std::string bench;
  std::string run;
  std::string serial; // of the sensor
  std::string file;   // as it was written
};

class DocumentRegister {
public:
  // In the database of a store; makes it if there is none.
  [[nodiscard]] static Expected<std::unique_ptr<DocumentRegister>> open(const std::string& place);

  // Before its file is written: a number that was given to nothing does less harm than a document
  // that nobody knows.
  [[nodiscard]] Expected<void> enter(const IssuedDocument& document,
                                     const ActingPerson& by = acting_person());
  // Of all results of a run, in the order of issue.
  [[nodiscard]] Expected<std::vector<IssuedDocument>> of_run(const std::string& bench,
                                                             const std::string& run);
  [[nodiscard]] Expected<std::optional<IssuedDocument>> find_file(const std::string& sha256);
  // Of each kind at most one.
  [[nodiscard]] Expected<std::vector<IssuedDocument>> of_number(const std::string& number) {
    return where("number", number);
  }
  // By serial number.
  [[nodiscard]] Expected<std::vector<IssuedDocument>> of_sensor(const std::string& serial) {
    return where("serial", serial);
  }
  // The number by which it was replaced; empty: none.
  [[nodiscard]] Expected<std::string> replacement_of(const std::string& number);

private:
  explicit DocumentRegister(std::unique_ptr<Database> database) : database_(std::move(database)) {}
  Expected<std::vector<IssuedDocument>> where(const std::string& column, const std::string& value);
  Expected<void> check(const IssuedDocument& document);
  Expected<void> check_replaced(const IssuedDocument& document);

  std::unique_ptr<Database> database_;
};

} // namespace dyncal::inline records
