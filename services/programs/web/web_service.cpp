#include "services/programs/web/web_service.hpp"

#include <ctime>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "services/daemon/program/daemon.hpp"
#include "services/daemon/supervision/supervisor.hpp"
#include "services/network/bus_readers.hpp"
#include "services/programs/web/actions.hpp"
#include "services/programs/web/event_stream.hpp"
#include "services/programs/web/history_answers.hpp"
#include "services/programs/web/journal_answers.hpp"
#include "services/programs/web/laboratory_answers.hpp"
#include "services/programs/web/permission.hpp"
#include "services/programs/web/run_files.hpp"
#include "services/programs/web/signal_answers.hpp"
#include "services/programs/web/state_cache.hpp"
#include "services/records/store/store.hpp"
#include "services/security/identity_check.hpp"
#include "services/views/signals/signal_tap.hpp"

namespace dyncal::inline programs::web {
namespace {

constexpr const char* all_benches = "*";
constexpr std::chrono::milliseconds max_wait{100};

} // namespace

struct WebService::Parts {
  Parts(Daemon& own, const WebOptions& web, ActionOptions action_options,
        const std::vector<TokenHolder>& tokens)
      : daemon(own), options(web),
        cache(clock, [this](nlohmann::ordered_json& json) { add_daemon(json); }),
        files(web.runs_folder), router(web.door, clock), permission(tokens, clock, router),
        answers(cache, files), tap(participant, clock), signals(cache, tap, clock),
        events(cache, answers, router,
               [this](const std::string& bench, const httplib::Request& request) {
                 return signals.signal(bench, request);
               }),
        history(store_of(web)), journal(cache, files, store_of(web)),
        actions(std::move(action_options), participant, clock, cache, router, permission) {}

  void add_daemon(nlohmann::ordered_json& json) const {
    json["daemon"] = {{"host", identity.host},
                      {"version", identity.software},
                      {"vendor", identity.dds},
                      {"samples_missed", std::to_string(tap.missed())},
                      {"is_open_to_others", is_open_to_others},
                      {"strangers", daemon.strangers()},
                      {"visitors", events.listeners()}};
    json["may_act"] = permission.may_act();
    json["has_guide"] = !options.door.guide_folder.empty();
  }
  static std::string store_of(const WebOptions& web) {
    return web.store.empty() && web.runs_folder.empty() ? ""
                                                        : store_place(web.store, web.runs_folder);
  }
  void add_answers();
  void report();

  bus::Clock& clock = bus::system_clock();
  Daemon& daemon;
  bus::Participant& participant = daemon.participant();
  const ProgramIdentity& identity = daemon.identity();
  WebOptions options;
  const bool is_open_to_others = daemon.is_open_to_others();
  std::shared_ptr<bus::WakeUp> wake_up = std::make_shared<bus::WakeUp>();
  std::optional<network::BusReaders> readers;
  StateCache cache;
  RunFiles files;
  RequestRouter router;
  Permission permission;
  LaboratoryAnswers answers;
  SignalTap tap;
  SignalAnswers signals;
  EventStream events;
  HistoryAnswers history;
  JournalAnswers journal;
  Actions actions;
};

// In the order in which they are asked.
void WebService::Parts::add_answers() {
  const auto ask = [](auto& answers_of) {
    return [&answers_of](const httplib::Request& request, httplib::Response& response) {
      return answers_of.answer(request, response);
    };
  };
  router.on_request([this](const auto& request, auto& response) {
    return permission.refuses_to_show(request, response);
  });
  router.on_get(ask(answers));
  router.on_get(ask(signals));
  router.on_get(ask(events));
  router.on_get(ask(history));
  router.on_get(ask(journal));
  router.on_get(
      [this](const auto& request, auto& response) { return actions.get(request, response); });
  router.on_post(
      [this](const auto& request, auto& response) { return actions.post(request, response); });
}

void WebService::Parts::report() {
  WebFigures figures{.visitors = events.listeners(),
                     .requests = router.requests(),
                     .refused = {},
                     .benches = 0,
                     .left_out = 0,
                     .samples_missed = tap.missed()};
  for (std::size_t i = 0; i < refusal_names.size(); ++i) {
    figures.refused.emplace_back(refusal_names[i], router.refusals().of(static_cast<Refusal>(i)));
  }
  cache.look([&](const network::BusState& laboratory) {
    const network::LeftOut& out = laboratory.left_out();
    figures.benches = laboratory.benches().size();
    figures.left_out = out.benches + out.sources + out.services + out.runs + out.results;
  });
  daemon.supervisor().report(figures);
}

WebService::WebService(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
WebService::~WebService() = default;

namespace {

// The certificate of the page itself conducts nothing: a run has one of its own.
Expected<void> check_run_security(const NetworkOptions& network, const std::string& folder) {
  if (folder.empty()) {
    return {};
  }
  if (network.security.empty()) {
    return fail(ErrorCode::bad_argument,
                "--run-security is for a secured laboratory: give --security, too");
  }
  DYNCAL_TRY(const auto vendor, bus::parse_vendor(network.dds));
  return require_identity(folder, vendor, "dyncal-run", std::time(nullptr));
}

} // namespace

Expected<std::unique_ptr<WebService>> WebService::create(Daemon& daemon,
                                                         const WebOptions& options) {
  DYNCAL_TRY(check_run_security(daemon.network, options.run_security));
  DYNCAL_TRY(daemon.join());
  ActionOptions actions{.benches_folder = options.benches_folder,
                        .runs_folder = options.runs_folder,
                        .network = daemon.network,
                        .run_security = options.run_security,
                        .sender = service_name(daemon.identity())};
  std::vector<TokenHolder> tokens;
  if (!options.token_file.empty()) {
    DYNCAL_TRY(tokens, read_tokens(options.token_file));
  }
  auto parts = std::make_unique<Parts>(daemon, options, std::move(actions), tokens);
  DYNCAL_TRY(auto readers,
             network::BusReaders::open(parts->participant, all_benches, parts->identity,
                                       parts->clock, parts->wake_up));
  parts->readers.emplace(std::move(readers));
  return std::unique_ptr<WebService>(new WebService(std::move(parts)));
}

Expected<void> WebService::serve() {
  Parts& parts = *parts_;
  const std::stop_token stop = parts.daemon.stop();
  parts.add_answers();
  DYNCAL_TRY(parts.router.start());
  if (!std::filesystem::exists(parts.options.door.javascript_folder + "/dygraphs/dygraph.min.js")) {
    spdlog::warn("{}/dygraphs is missing: the page shows no charts (Debian: libjs-dygraphs)",
                 parts.options.door.javascript_folder);
  }
  const std::string page = "page at " + parts.router.address();
  parts.daemon.supervisor().describe(page);
  parts.daemon.supervisor().serving();
  spdlog::info("web ready ({}), {}", parts.identity.dds, page);
  while (!stop.stop_requested()) {
    parts.clock.wait(*parts.wake_up, parts.clock.now() + max_wait);
    parts.cache.change([&](network::BusState& laboratory) { parts.readers->work(laboratory); });
    parts.report();
    parts.daemon.turned();
  }
  parts.router.stop();
  return {};
}

} // namespace dyncal::inline programs::web
