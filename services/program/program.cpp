#include "services/program/program.hpp"

#include <csignal>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace dyncal::services {
namespace {

std::atomic<bool> stop_requested{false};
std::string program_name = "dyncal";

extern "C" void request_stop(int) { stop_requested.store(true); }

std::vector<std::string> vendor_words() {
  std::vector<std::string> words;
  for (const bus::Vendor vendor : bus::vendors_in_this_build()) {
    words.push_back(bus::vendor_word(vendor));
  }
  return words;
}

} // namespace

void add_network_options(CLI::App& app, NetworkOptions& options) {
  const std::vector<std::string> words = vendor_words();
  if (!words.empty()) {
    options.dds = words.front();
  }
  app.add_option("--dds", options.dds, "DDS implementation that carries the messages")->check(CLI::IsMember(words))->capture_default_str();
  app.add_option("--domain", options.domain, "DDS domain: one per laboratory")->check(CLI::Range(0, 232))->capture_default_str();
  app.add_option("--peer", options.peers, "address of another host, where the network has no multicast (repeatable)");
  app.add_flag("--no-multicast", options.no_multicast, "find others by --peer alone");
  app.add_option("--interface", options.interface_name, "network interface to use (name or address)");
}

Expected<bus::Participant> join_network(const NetworkOptions& options, const std::string& program) {
  const auto vendor = bus::parse_vendor(options.dds);
  if (!vendor) {
    return tl::unexpected(vendor.error());
  }
  bus::ParticipantOptions participant;
  participant.vendor = *vendor;
  participant.domain = options.domain;
  participant.name = program;
  participant.peers = options.peers;
  participant.multicast = !options.no_multicast;
  participant.interface_name = options.interface_name;
  participant.warn = [](const std::string& sentence) { spdlog::warn("{}", sentence); };
  return bus::Participant::create(participant);
}

void set_up_log(const std::string& program) {
  program_name = program;
  auto logger = std::make_shared<spdlog::logger>(program, std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_pattern("%Y-%m-%dT%H:%M:%S.%e %n %l: %v");
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

const std::atomic<bool>& stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  return stop_requested;
}

int fail(const Error& error) {
  fmt::print(stderr, "{}: {}\n", program_name, error.message);
  return error.code == ErrorCode::interrupted ? 130 : error.code == ErrorCode::bad_argument ? 2 : 1;
}

} // namespace dyncal::services
