// A JSON value held against a schema (JSON Schema 2020-12): the first deviation as a sentence that
// begins with its place, "transfer_function[3].U_magnitude is a text, not a number or null".
//
// Known words: $ref (to "#/$defs/..."), type, enum, const, pattern, minimum, maximum,
// exclusiveMinimum, exclusiveMaximum, minItems, maxItems, required, properties,
// additionalProperties, items, if, then, else. `title`, `description`, `$schema` and `$defs`
// say nothing about a value; a schema with any other word is a fault of the program and fails every
// value. A member that the schema does not describe is no deviation unless it says so. Texts that a
// pattern is about have at most 4096 bytes, for std::regex needs stack by their length.
//
// Plain function, any thread; both values outlive the call alone.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace dyncal::inline views {

[[nodiscard]] std::optional<std::string> deviation_from(const nlohmann::json& schema,
                                                        const nlohmann::json& value);

} // namespace dyncal::inline views
