// Writes and reads the members of a struct as one of the contract's messages carries them. Each
// message pairs every member with its place once, and both directions are visitors over that list:
//
//   void message_members(auto& visit, Either<SourceSamples> auto& one, auto& message)
//
//   visit(one.lost, message.lost())              number, text, truth, list, list of structs that
//                                                have a list of members with their messages
//   visit.named(one.kind, message.kind(), table) an enumeration by a table of pairs; the first one
//                                                is what an unknown value is taken for
//   visit.flags(one.flags, message)              sentences and names
//   visit.present(one.delay, message.valid())    the value of an optional, or null where the
//                                                message has none
//
// The struct is constant where it is written, the message where it is read. The contract has names
// of its own, so these lists stand beside those of members.hpp. Templates, any thread.
#pragma once

#include <algorithm>
#include <optional>
#include <type_traits>
#include <vector>

#include "services/evaluation/result/members.hpp"
#include "services/evaluation/result/result_flag.hpp"

namespace dyncal::inline evaluation {

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
  template <class Message>
  void flags(const std::vector<Flag>& flags, Message& message) {
    message.flags() = sentences_of(flags);
    message.flag_names() = names_of(flags);
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
  template <class Message>
  void flags(std::vector<Flag>& flags, const Message& message) {
    flags = flags_from_message(message.flags(), message.flag_names());
  }
  template <class T>
  T* present(std::optional<T>& value, bool is_present) {
    return is_present ? &value.emplace() : nullptr;
  }
};

} // namespace dyncal::inline evaluation
