// The daemon: feeds the cache from the bus, and serves its answers.
//
// The main loop (serve()) takes what has come and reports to the supervisor; requests are answered
// by the threads of the router. Samples are read only while somebody looks at a signal. One thread,
// but for what the router does.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "services/base/error.hpp"
#include "services/programs/web/request_router.hpp"

namespace dyncal::inline daemon {
class Daemon;
}

namespace dyncal::inline programs::web {

struct WebOptions {
  DoorOptions door;
  std::filesystem::path runs_folder; // empty: no downloads
  std::string store;                 // as store_place() takes it
  std::filesystem::path token_file;  // empty: no actions
  std::filesystem::path benches_folder;
  std::string run_security; // folder of runs that are started here; empty: they are not secured
};

class WebService {
public:
  // Joins the network with the daemon, which outlives it, and serves until it stops. Fails as the
  // network, the token file and the address do.
  [[nodiscard]] static Expected<std::unique_ptr<WebService>> create(Daemon& daemon,
                                                                    const WebOptions& options);
  ~WebService();
  WebService(const WebService&) = delete;
  WebService& operator=(const WebService&) = delete;

  [[nodiscard]] Expected<void> serve();

private:
  struct Parts;
  explicit WebService(std::unique_ptr<Parts> parts);

  std::unique_ptr<Parts> parts_;
};

} // namespace dyncal::inline programs::web
