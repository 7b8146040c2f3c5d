// In which line of a bench file a key is. Made once from its text, then read only; any thread.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/bench/file/toml_names.hpp"

namespace dyncal::inline checks::bench_check {

// The names of the tables around a key, and its own: {"sources", "dau", "listen"}.
using KeyPath = std::vector<std::string>;

// "sources.dau.listen"
[[nodiscard]] std::string text_of(const KeyPath& path);

class KeyLines {
public:
  explicit KeyLines(const std::string& bench_text);

  // Of the key, of one entry of its list, or of the innermost table around it that is there; 1 when
  // the text is not valid TOML.
  [[nodiscard]] std::size_t line_of(const KeyPath& path,
                                    std::optional<std::size_t> entry = std::nullopt) const;
  // The text that the key has; nothing when it is not there or has another type.
  [[nodiscard]] std::optional<std::string> text_at(const KeyPath& path) const;

private:
  std::shared_ptr<const toml::table> root_; // null: not valid TOML
};

} // namespace dyncal::inline checks::bench_check
