// Reads one table of a TOML file and refuses what it does not know.
//
// Every getter records that its key is known; `finish` then refuses the keys nobody asked for. All
// problems are collected, the first of every key or entry of a list: what follows from it tells
// nothing new. Belongs to one thread; the toml::table must outlive it.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/bench/file/asked_keys.hpp"
#include "services/bench/file/bench_problem.hpp"
#include "services/bench/file/toml_names.hpp"

namespace dyncal::inline bench {

class TomlTable {
public:
  // `name` is the dotted name of the table ("" for the file itself); what is found is added to
  // `problems`.
  TomlTable(const toml::table& table, std::string name, std::string file, BenchProblems& problems);

  [[nodiscard]] bool has(const std::string& key) const;
  [[nodiscard]] std::string required_text(const std::string& key);
  [[nodiscard]] std::string text(const std::string& key, const std::string& otherwise = "");
  [[nodiscard]] double number(const std::string& key, double otherwise, const std::string& unit);
  [[nodiscard]] std::optional<double> optional_number(const std::string& key,
                                                      const std::string& unit);
  [[nodiscard]] int whole_number(const std::string& key, int otherwise, int least,
                                 const std::string& unit = {});
  [[nodiscard]] bool yes_no(const std::string& key, bool otherwise);
  [[nodiscard]] std::vector<std::string> texts(const std::string& key);
  [[nodiscard]] std::vector<double>
  numbers(const std::string& key,
          const std::string& unit); // a number alone counts as a list of one
  [[nodiscard]] std::map<std::string, std::string> text_map(const std::string& key);
  [[nodiscard]] std::map<std::string, double> number_map(const std::string& key);
  [[nodiscard]] std::string one_of(const std::string& key, const std::vector<std::string>& words,
                                   const std::string& otherwise);
  // The sub-table, or nothing when it is not there.
  [[nodiscard]] std::optional<TomlTable> table(const std::string& key);
  [[nodiscard]] const toml::node* node(const std::string& key);
  [[nodiscard]] std::vector<std::string> keys() const;
  // Every key but those, one "key = value" a line (services/contract/bench_file_origin.hpp).
  [[nodiscard]] std::string lines_without(const std::set<std::string>& keys) const;

  // Refuses keys that were not asked for; then what was said of keys that are not there, unless a
  // misspelt one explains it.
  void finish();
  // Records "FILE:LINE: key 'table.key' <what>"; at `finish` if the key is not there.
  void refuse(const std::string& key, const std::string& what);
  // The same of one entry of a list or table.
  void refuse_entry(const std::string& key, std::size_t entry, const std::string& what);
  // Whether the key was refused, so that nothing can be concluded from its value.
  [[nodiscard]] bool refused(const std::string& key) const;
  [[nodiscard]] std::string where(const std::string& key) const; // "FILE:LINE"

private:
  [[nodiscard]] const toml::node* find(const std::string& key);
  [[nodiscard]] std::string full_name(const std::string& key) const;
  // Tells anyone who collects what is asked for; `what.name` is filled in here.
  void tell(const std::string& key, AskedKey what) const;
  [[nodiscard]] const toml::source_region& region(const std::string& key) const;

  const toml::table& table_;
  std::string name_;
  std::string file_;
  BenchProblems& problems_;
  std::set<std::string> known_;
  std::set<std::pair<std::string, std::size_t>> refused_; // keys and their entries
  std::map<std::string, std::string> about_absent_keys_;  // what `finish` is to record
  std::vector<std::string> absent_keys_;                  // in the order of the refusals
};

} // namespace dyncal::inline bench
