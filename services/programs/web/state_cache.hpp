// The newest state of the laboratory between the thread that feeds it and those that show it.
//
// Texts of JSON are made when somebody asks, at most once in `text_age`, and shared by all who ask
// meanwhile: visitors cost writing, not counting. Results and figures are made again only when they
// change.
//
// Memory follows what is shown: a run's texts go with the run, every text once nobody has asked for
// it for `forgotten_after`, and the one not asked for longest where `max_texts` or `max_bytes` are
// reached. Policy: the newest wins, nothing queues. Any thread.
#pragma once

#include <chrono>
#include <compare>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "services/network/bus_state.hpp"
#include "services/views/figures/transfer_function.hpp"

namespace dyncal::inline programs::web {

using Text = std::shared_ptr<const std::string>;

// The current one where `run` is empty; null: there is none, or no bench.
[[nodiscard]] const network::Run* find_run(const network::Bench* bench, const std::string& run);

class StateCache {
public:
  static constexpr std::chrono::milliseconds text_age{200};
  // A page asks for what it shows at least every second.
  static constexpr std::chrono::seconds forgotten_after{20};
  static constexpr std::size_t max_texts = 256;
  // Of all of them: results and figures of a run of 36 steps are 0.25 MB, of 8 runs 2 MB.
  static constexpr std::size_t max_bytes = std::size_t{8} * 1024 * 1024;
  // Adds what the daemon knows of itself to the laboratory.
  using AddDaemon = std::function<void(nlohmann::ordered_json&)>;

  // `clock` outlives the object.
  StateCache(bus::Clock& clock, AddDaemon add_daemon)
      : laboratory_(clock), add_daemon_(std::move(add_daemon)) {}

  template <class Change>
  void change(Change&& change) {
    const std::lock_guard lock(mutex_);
    change(laboratory_);
    drop_what_is_not_shown();
  }
  template <class Look>
  auto look(Look&& look) const {
    const std::lock_guard lock(mutex_);
    return look(laboratory_);
  }

  [[nodiscard]] Text laboratory();
  // Null: no such bench.
  [[nodiscard]] Text bench(const std::string& name);
  // Of its current run if `run` is empty; null: no such bench or run. `files` is added.
  using AddFiles = std::function<void(const std::string& run, nlohmann::ordered_json&)>;
  [[nodiscard]] Text results(const std::string& bench, const std::string& run,
                             const AddFiles& add_files);
  // The pictures of one channel of that run; null also: it has no result of this channel.
  [[nodiscard]] Text figures(const std::string& bench, const std::string& run,
                             const std::string& channel, dyncal::figures::ErrorBars error_bars);
  // Of the laboratory, or of the results of the current run of a bench.
  [[nodiscard]] std::uint64_t number() const;
  [[nodiscard]] std::uint64_t results_number(const std::string& bench) const;
  // Texts held, and their bytes.
  struct Held {
    std::size_t texts = 0;
    std::size_t bytes = 0;
  };
  [[nodiscard]] Held held() const;

private:
  struct TextKey {
    std::string kind; // "laboratory", "bench", "run", "figures U"
    std::string bench;
    std::string run; // empty: the text is of no run
    std::string channel;

    // NOLINTNEXTLINE(modernize-use-nullptr): the check takes the comparison for a pointer
    auto operator<=>(const TextKey&) const = default;
  };
  struct Made {
    Text text;
    bus::Clock::Instant when;
    std::uint64_t number = 0; // of results
    bus::Clock::Instant asked;
  };

  [[nodiscard]] Text keep(const TextKey& key, const nlohmann::ordered_json& json,
                          std::uint64_t number = 0);
  // Null: there is none. Notes that it was asked for.
  [[nodiscard]] const Made* find(const TextKey& key);
  [[nodiscard]] Text young(const TextKey& key);
  void drop_what_is_not_shown();
  void make_room(std::size_t bytes);
  [[nodiscard]] std::size_t bytes() const;

  mutable std::mutex mutex_;
  network::BusState laboratory_;
  AddDaemon add_daemon_;
  std::map<TextKey, Made> texts_;
};

} // namespace dyncal::inline programs::web
