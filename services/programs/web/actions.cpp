#include "services/programs/web/actions.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "services/bench/file/bench_file.hpp"
#include "services/contract/time_name.hpp"
#include "services/contract/topics.hpp"
#include "services/programs/web/laboratory_answers.hpp"

namespace dyncal::inline programs::web {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* target = "conductor";

void answer_action(bool accepted, const std::string& by, const std::string& message,
                   httplib::Response& response) {
  response.status = accepted ? 200 : 409;
  answer_json({{"answer", accepted ? "accepted" : "refused"}, {"by", by}, {"message", message}},
              response);
}

// A member of what a visitor sent; empty: it is no object, or has no such text.
std::string text_of(const Json& body, const char* member) {
  const Json text = body.is_object() ? body.value(member, Json()) : Json();
  return text.is_string() ? text.get<std::string>() : "";
}

std::optional<wire::CommandKind> kind_of(const std::string& word) {
  const std::map<std::string, wire::CommandKind> kinds{{"repeat", wire::COMMAND_REPEAT},
                                                       {"abort", wire::COMMAND_ABORT},
                                                       {"pause", wire::COMMAND_PAUSE},
                                                       {"continue", wire::COMMAND_CONTINUE}};
  const auto found = kinds.find(word);
  return found == kinds.end() ? std::nullopt : std::optional(found->second);
}

// The folder's own bench files, by name.
std::vector<std::string> bench_files_of(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code unknown;
  for (const auto& entry : fs::directory_iterator(folder, unknown)) {
    if (entry.path().extension() == ".toml" && entry.is_regular_file(unknown)) {
      names.push_back(entry.path().filename().string());
    }
  }
  std::ranges::sort(names);
  return names;
}

// What a visitor may say of a run, and the option of `dyncal run` that takes it.
constexpr std::array<std::pair<const char*, const char*>, 4> run_members{
    {{"run", "--run"},
     {"sensor", "--sensor"},
     {"operator", "--operator"},
     {"comment", "--comment"}}};
constexpr std::size_t max_text_bytes = 200;

// Of the members that are given, and `actor`, whose token it is, as operator where none is. As one
// word each: no text can be an option of its own. Fails (bad_argument) for a text that is too long.
Expected<std::vector<std::string>> stated_arguments(const Json& body, const std::string& actor) {
  std::vector<std::string> arguments;
  for (const auto& [member, option] : run_members) {
    std::string text = text_of(body, member);
    if (text.size() > max_text_bytes) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("'{}' is longer than {} bytes", member, max_text_bytes));
    }
    text = text.empty() && std::string_view(member) == "operator" ? actor : text;
    if (!text.empty()) {
      arguments.push_back(fmt::format("{}={}", option, text));
    }
  }
  return arguments;
}

std::vector<std::string> run_arguments(const ActionOptions& options, const std::string& name) {
  const NetworkOptions& network = options.network;
  const fs::path file = options.benches_folder / name;
  std::vector<std::string> arguments{
      "run",       file.string(),   "--dds",    network.dds,
      "--vendors", network.vendors, "--domain", std::to_string(network.domain)};
  if (!options.runs_folder.empty()) {
    arguments.insert(arguments.end(), {"--folder", options.runs_folder.string()});
  }
  if (!options.run_security.empty()) {
    arguments.insert(arguments.end(), {"--security", options.run_security});
  }
  for (const std::string& peer : network.peers) {
    arguments.insert(arguments.end(), {"--peer", peer});
  }
  if (network.no_multicast) {
    arguments.emplace_back("--no-multicast");
  }
  if (!network.interface_name.empty()) {
    arguments.insert(arguments.end(), {"--interface", network.interface_name});
  }
  return arguments;
}

// The one that is commanded; null: it is not the bench's run now.
const network::Run* run_of(const network::BusState& laboratory, const wire::Command& command) {
  const network::Bench* bench = laboratory.bench(command.bench().to_string());
  const network::Run* run = bench == nullptr ? nullptr : bench->current_run();
  return run != nullptr && run->name == command.run() ? run : nullptr;
}

// Nothing: no conductor runs it.
std::optional<std::string> conductor_of(const network::BusState& laboratory,
                                        const wire::Command& command, bus::Clock::Instant now) {
  const network::Run* run = run_of(laboratory, command);
  if (run == nullptr || run->is_over() || !run->conductor_heard || run->is_left_alone(now)) {
    return std::nullopt;
  }
  return run->plan ? run->plan->conductor : "";
}

std::uint64_t drawn_id() {
  std::random_device random;
  std::uint64_t id = 0;
  while (id == 0) { // which is none
    id = (std::uint64_t{random()} << 32U) | random();
  }
  return id;
}

} // namespace

Actions::Actions(ActionOptions options, bus::Participant& participant, bus::Clock& clock,
                 StateCache& cache, RequestRouter& router, Permission& permission)
    : options_(std::move(options)), participant_(participant), clock_(clock), cache_(cache),
      router_(router), permission_(permission) {}

bool Actions::post(const httplib::Request& request, httplib::Response& response) {
  const auto address = bench_address(request.path);
  const bool is_command = address && address->part == "command";
  if (!is_command && request.path != "/api/run") {
    return false;
  }
  const Json body = Json::parse(request.body, nullptr, false);
  const std::string word = text_of(body, "command");
  const bool stops = is_command && kind_of(word) == wire::COMMAND_ABORT;
  const auto actor = permission_.actor_of(request, response,
                                          stops ? TokenUse::stops_the_exciter : TokenUse::ordinary);
  if (!actor) {
    return true;
  }
  const std::string by = actor->empty() ? "" : *actor + ", ";
  if (is_command) {
    command(address->bench, body, by + options_.sender, request, response);
  } else if (const auto stated = stated_arguments(body, *actor); stated) {
    start_run(text_of(body, "file"), *stated, response);
  } else {
    answer_error(400, "malformed", stated.error().message, response);
  }
  spdlog::info("{} of {}{}: {} {}", request.path, by, request.remote_addr, response.status,
               response.body);
  return true;
}

bool Actions::get(const httplib::Request& request, httplib::Response& response) {
  if (request.path != "/api/bench-files") {
    return false;
  }
  if (permission_.actor_of(request, response)) {
    list_bench_files(response);
  }
  return true;
}

void Actions::command(const std::string& bench, const Json& body, const std::string& sender,
                      const httplib::Request& request, httplib::Response& response) {
  const std::string word = text_of(body, "command");
  const auto kind = kind_of(word);
  const Json step = body.is_object() ? body.value("step", Json()) : Json();
  const Json run = body.is_object() ? body.value("run", Json()) : Json();
  const bool has_step = step.is_number_unsigned() && step.get<std::uint64_t>() > 0 &&
                        step.get<std::uint64_t>() < 1'000'000;
  if (!kind || !run.is_string() || (*kind == wire::COMMAND_REPEAT && !has_step)) {
    router_.refuse(Refusal::malformed, 400,
                   "the body must be {\"command\": \"repeat|abort|pause|continue\", \"run\": RUN, "
                   "\"step\": N of repeat}",
                   request, response);
    return;
  }
  wire::Command message;
  message.bench(bench);
  message.target(target);
  message.kind(*kind);
  message.run(run.get<std::string>());
  message.sender(sender);
  message.step(has_step ? step.get<std::uint32_t>() : 0);
  message.id(drawn_id());
  send(message, word, response);
}

void Actions::send(const wire::Command& command, const std::string& word,
                   httplib::Response& response) {
  const auto conductor = cache_.look([&](const network::BusState& laboratory) {
    return conductor_of(laboratory, command, clock_.now());
  });
  if (!conductor) {
    answer_action(false, "", "no conductor is running this run", response);
    return;
  }
  const auto refusal = repeat_until_answered(command);
  if (!refusal) {
    answer_action(
        false, *conductor,
        fmt::format("the conductor did not answer {} within {} s; one of dyncal 0.1 never "
                    "does: look whether the effect shows",
                    word, answer_limit.count()),
        response);
  } else if (!refusal->empty()) {
    answer_action(false, *conductor, *refusal, response);
  } else if (command.kind() == wire::COMMAND_REPEAT) {
    answer_action(
        true, *conductor,
        fmt::format("step {} is excited once more after the planned steps", command.step()),
        response);
  } else {
    answer_action(true, *conductor, word + ": done", response);
  }
}

std::optional<std::string> Actions::repeat_until_answered(const wire::Command& command) {
  std::unique_lock lock(mutex_, std::defer_lock);
  if (command.kind() != wire::COMMAND_ABORT) { // which waits for no other command
    lock.lock();
  }
  auto writer = participant_.writer(bus::topics::command, command.bench().to_string());
  if (!writer) {
    spdlog::error("{}", writer.error().message);
    return std::nullopt;
  }
  const auto end = clock_.now() + answer_limit;
  while (clock_.now() < end) {
    writer->write(command, std::chrono::milliseconds(100));
    if (!router_.wait_until(clock_.now() + command_interval)) {
      break;
    }
    auto refusal = cache_.look([&](const network::BusState& laboratory) {
      const network::Run* run = run_of(laboratory, command);
      return run != nullptr && run->answer.command == command.id()
                 ? std::optional(run->answer.refusal)
                 : std::nullopt;
    });
    if (refusal) {
      return refusal;
    }
  }
  return std::nullopt;
}

void Actions::list_bench_files(httplib::Response& response) const {
  Json files = Json::array();
  for (const std::string& name : bench_files_of(options_.benches_folder)) {
    const auto bench = read_bench_file(options_.benches_folder / name);
    files.push_back({{"file", name},
                     {"bench", bench ? Json(bench->bench) : Json(nullptr)},
                     {"problem", bench ? Json(nullptr) : Json(bench.error().message)}});
  }
  Json members = Json::array();
  for (const auto& [member, option] : run_members) {
    members.push_back(member);
  }
  answer_json({{"files", std::move(files)}, {"members", std::move(members)}}, response);
}

void Actions::start_run(const std::string& name, const std::vector<std::string>& stated,
                        httplib::Response& response) {
  const std::vector<std::string> known = bench_files_of(options_.benches_folder);
  if (std::ranges::find(known, name) == known.end()) {
    answer_action(false, "", "there is no such bench file in the folder of --benches", response);
    return;
  }
  if (!options_.network.security.empty() && options_.run_security.empty()) {
    answer_action(false, "",
                  "this laboratory is secured, and dyncal-web has no certificate to conduct runs "
                  "with: give it the folder of an operator by --run-security",
                  response);
    return;
  }
  const std::lock_guard lock(mutex_);
  if (const auto run = runs_.find(name); run != runs_.end() && !run->second.running()) {
    runs_.erase(run);
  }
  if (runs_.contains(name)) {
    answer_action(false, "", name + ": a run of this bench file is under way", response);
    return;
  }
  std::error_code unknown;
  const fs::path logs =
      options_.runs_folder.empty() ? fs::temp_directory_path(unknown) : options_.runs_folder;
  fs::create_directories(logs, unknown); // the first run of all; if it fails, the log file tells
  const fs::path log =
      logs / fmt::format("{}-{}.log", name, time_name(bus::system_clock().utc_now_ns()));
  std::vector<std::string> arguments = run_arguments(options_, name);
  arguments.insert(arguments.end(), stated.begin(), stated.end());
  auto child = ChildProcess::start(program_folder() / "dyncal", arguments, {log, log});
  if (!child) {
    answer_action(false, "", child.error().message, response);
    return;
  }
  const std::string started = fmt::format("dyncal run {} is process {}, its output is in {}", name,
                                          child->id(), log.string());
  runs_.emplace(name, std::move(*child));
  answer_action(true, "dyncal run", started, response);
}

} // namespace dyncal::inline programs::web
