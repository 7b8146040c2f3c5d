// What the readers of bench, laboratory and sensor files ask for: every key with its type, unit and
// default. The guide's reference of keys is held against it (tests/guide), so that no key is read
// that is not described.
//
// While an AskedKeys lives, every TomlTable of its thread tells it what it is asked; it costs next
// to nothing otherwise. One at a time in a thread.
#pragma once

#include <string>
#include <vector>

namespace dyncal::inline bench {

struct AskedKey {
  std::string name{};  // dotted: "excitation.level"
  std::string type{};  // "number", "list of texts", ...; empty: only asked whether it is there
  std::string unit{};  // of numbers
  std::string value{}; // that is taken when the key is not there, as TOML; empty: none
  std::vector<std::string> choices{}; // where only some texts are allowed

  friend bool operator==(const AskedKey&, const AskedKey&) = default;
};

class AskedKeys {
public:
  AskedKeys();
  ~AskedKeys();
  AskedKeys(const AskedKeys&) = delete;
  AskedKeys& operator=(const AskedKeys&) = delete;

  // In the order of the first question; a key that was asked for in two ways is there twice.
  [[nodiscard]] const std::vector<AskedKey>& all() const { return all_; }

  // Where a question goes that is asked in this thread: nullptr if nobody wants to know.
  [[nodiscard]] static AskedKeys* listening();
  void add(AskedKey key);

private:
  std::vector<AskedKey> all_;
};

} // namespace dyncal::inline bench
