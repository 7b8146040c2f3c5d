// A visitor of dyncal-web for a test: asks for JSON, until it is as expected.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include <gtest/gtest.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "services/bus/wake_up.hpp"
#include "tests/patience.hpp"
#include "tests/system/program_run.hpp"

namespace dyncal::tests {

// "page at http://127.0.0.1:PORT/"
inline int port_of(const ProgramRun& web) {
  const std::string log = web.errors();
  const std::string begin = "page at http://127.0.0.1:";
  return std::stoi(log.substr(log.find(begin) + begin.size()));
}

class WebVisitor {
public:
  using Holds = std::function<bool(const nlohmann::json&)>;

  explicit WebVisitor(const ProgramRun& web, const std::string& token = "")
      : client_("127.0.0.1", port_of(web)) {
    client_.set_read_timeout(std::chrono::seconds(20));
    if (!token.empty()) {
      client_.set_default_headers({{"Authorization", "Bearer " + token}});
    }
  }

  [[nodiscard]] std::string text(const std::string& address) {
    const auto answer = client_.Get(address);
    return answer ? answer->body : "";
  }
  [[nodiscard]] nlohmann::json ask(const std::string& address) {
    return nlohmann::json::parse(text(address), nullptr, false);
  }
  // The first answer for which it holds, or the last one. Of an error it never holds.
  [[nodiscard]] nlohmann::json ask_until(const std::string& address, const Holds& holds) {
    const auto end = std::chrono::steady_clock::now() + patience;
    bus::WakeUp pacing;
    nlohmann::json answer = ask(address);
    while (!(answer.is_object() && !answer.contains("error") && holds(answer)) &&
           std::chrono::steady_clock::now() < end) {
      pacing.wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(50));
      answer = ask(address);
    }
    return answer;
  }
  // Its answer, with the status of HTTP as `status`.
  [[nodiscard]] nlohmann::json post(const std::string& address, const nlohmann::json& body) {
    const auto answer = client_.Post(address, body.dump(), "application/json");
    nlohmann::json json =
        answer ? nlohmann::json::parse(answer->body, nullptr, false) : nlohmann::json::object();
    json["status"] = answer ? answer->status : 0;
    return json;
  }

private:
  httplib::Client client_;
};

} // namespace dyncal::tests
