// Writes and reads the members of a struct as one of the contract's messages carries them. Each
// message pairs every member with its place once, and both directions are visitors over that list:
//
//   void message_members(auto& visit, Either<SourceSamples> auto& one, auto& message)
//
//   visit(one.lost, message.lost())              number, text, truth, list, list of structs that
//                                                have a list of members with their messages
//   visit.named(one.kind, message.kind(), table) an enumeration by a table of pairs; the first one
//                                                is what an unknown value is taken for
//   visit.present(one.delay, message.valid())    the value of an optional, or null where the
//                                                message has none
//
// The struct is constant where it is written, the message where it is read. Templates, any thread.
#pragma once

#include <algorithm>
#include <concepts>
#include <optional>
#include <type_traits>
#include <vector>

namespace dyncal::inline contract {

// Constant where it is written, variable where it is read.
template <class T, class Struct>
concept Either = std::same_as<std::remove_const_t<T>, Struct>;

struct MessageWriter {
  template <class T, class Place>
  void operator()(const T& value, Place& place) {
    if constexpr (std::is_arithmetic_v<T>) {
      place = static_cast<Place>(value);
    } else {
      place = value;
    }
  }
  template <class T, class Message>
  void operator()(const std::vector<T>& values, std::vector<Message>& places) {
    if constexpr (std::is_same_v<T, Message>) {
      places = values;
    } else {
      for (const T& value : values) {
        message_members(*this, value, places.emplace_back());
      }
    }
  }
  template <class Table, class T, class Place>
  void named(const T& value, Place& place, const Table& table) {
    const auto found = std::find_if(table.begin(), table.end(),
                                    [&](const auto& pair) { return pair.first == value; });
    place = found == table.end() ? table.front().second : found->second;
  }
  template <class T>
  const T* present(const std::optional<T>& value, bool& is_present) {
    is_present = value.has_value();
    return value ? &*value : nullptr;
  }
};

struct MessageReader {
  template <class T, class Place>
  void operator()(T& value, const Place& place) {
    if constexpr (requires { place.to_string(); }) {
      value = place.to_string();
    } else {
      value = place;
    }
  }
  template <class T, class Message>
  void operator()(std::vector<T>& values, const std::vector<Message>& places) {
    if constexpr (std::is_same_v<T, Message>) {
      values = places;
    } else {
      for (const Message& place : places) {
        message_members(*this, values.emplace_back(), place);
      }
    }
  }
  template <class Table, class T, class Place>
  void named(T& value, const Place& place, const Table& table) {
    const auto found = std::find_if(table.begin(), table.end(),
                                    [&](const auto& pair) { return pair.second == place; });
    value = found == table.end() ? table.front().first : found->first;
  }
  template <class T>
  T* present(std::optional<T>& value, bool is_present) {
    return is_present ? &value.emplace() : nullptr;
  }
};

} // namespace dyncal::inline contract
