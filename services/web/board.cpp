#include "services/web/board.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/json_text.hpp"
#include "services/live/laboratory_json.hpp"
#include "services/live/run_figures.hpp"
#include "services/live/run_json.hpp"
#include "services/report/picture_json.hpp"

namespace dyncal::services::web {
namespace {

using Json = nlohmann::ordered_json;

const live::Run* find_run(const live::Bench& bench, const std::string& run) {
  if (run.empty()) {
    return bench.current_run();
  }
  const auto found = bench.runs.find(run);
  return found == bench.runs.end() ? nullptr : &found->second;
}

std::string bars_name(services::figures::ErrorBars bars) {
  return bars == services::figures::ErrorBars::none ? "none" : symbol_of(bars);
}

Json milliseconds(std::int64_t utc_ns) {
  return utc_ns == 0 ? Json(nullptr) : Json(static_cast<double>(utc_ns) / 1e6);
}

Json runs_json(const live::Bench& bench) {
  Json runs = Json::array();
  for (const auto& [name, run] : bench.runs) {
    runs.push_back({{"run", name},
                    {"planned_utc_ms", milliseconds(run.time_utc_ns())},
                    {"state", live::to_string(run.state())}});
  }
  return runs;
}

} // namespace

Text Board::young(const std::string& key) {
  const auto found = texts_.find(key);
  const bool is_young =
      found != texts_.end() && laboratory_.clock().now() - found->second.when < text_age;
  return is_young ? found->second.text : nullptr;
}

Text Board::keep(const std::string& key, const Json& json, std::uint64_t number) {
  Text text = std::make_shared<const std::string>(json_text(json));
  std::size_t bytes = text->size();
  for (const auto& [other, made] : texts_) {
    bytes += made.text->size();
  }
  if (texts_.size() >= max_texts || bytes > max_bytes) {
    texts_.clear();
  }
  texts_[key] = Made{text, laboratory_.clock().now(), number};
  return text;
}

Text Board::laboratory() {
  const std::lock_guard lock(mutex_);
  const std::string key = "laboratory";
  if (Text text = young(key)) {
    return text;
  }
  Json json = live::laboratory_json(laboratory_);
  add_daemon_(json);
  return keep(key, json);
}

Text Board::bench(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const live::Bench* bench = laboratory_.bench(name);
  if (bench == nullptr) {
    return nullptr;
  }
  const std::string key = "bench " + name;
  if (Text text = young(key)) {
    return text;
  }
  return keep(key, live::bench_json(laboratory_, *bench));
}

Text Board::results(const std::string& name, const std::string& run_name,
                    const AddFiles& add_files) {
  const std::lock_guard lock(mutex_);
  const live::Bench* bench = laboratory_.bench(name);
  const live::Run* run = bench == nullptr ? nullptr : find_run(*bench, run_name);
  if (run == nullptr) {
    return nullptr;
  }
  const std::string key = "run " + name + "/" + run->name;
  const std::uint64_t number = run->results_number;
  const auto made = texts_.find(key);
  const bool is_over = run->is_over(); // then files come and go
  if (made != texts_.end() && made->second.number == number && (!is_over || young(key))) {
    return made->second.text;
  }
  Json json{{"number", number},
            {"now_utc_ms", milliseconds(laboratory_.clock().utc_now_ns())},
            {"bench", name}};
  json.update(live::run_json(*run));
  json["runs"] = runs_json(*bench);
  add_files(run->name, json);
  return keep(key, json, number);
}

Text Board::figures(const std::string& name, const std::string& run_name,
                    const std::string& channel, services::figures::ErrorBars error_bars) {
  const std::lock_guard lock(mutex_);
  const live::Bench* bench = laboratory_.bench(name);
  const live::Run* run = bench == nullptr ? nullptr : find_run(*bench, run_name);
  if (run == nullptr) {
    return nullptr;
  }
  const std::string bars = bars_name(error_bars);
  const std::string key = fmt::format("figures {}\n{}\n{}\n{}", bars, name, run->name, channel);
  const std::uint64_t number = run->results_number;
  const auto made = texts_.find(key);
  if (made != texts_.end() && made->second.number == number) {
    return made->second.text;
  }
  Json pictures = Json::array();
  for (const services::figures::Figure& figure :
       live::run_figures(name, *run, channel, error_bars)) {
    pictures.push_back(picture_json(figure));
  }
  if (pictures.empty()) {
    return nullptr;
  }
  return keep(key,
              Json{{"number", number},
                   {"bench", name},
                   {"run", run->name},
                   {"channel", channel},
                   {"bars", bars},
                   {"pictures", std::move(pictures)}},
              number);
}

std::uint64_t Board::number() const {
  const std::lock_guard lock(mutex_);
  return laboratory_.number();
}

std::uint64_t Board::results_number(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const live::Bench* bench = laboratory_.bench(name);
  const live::Run* run = bench == nullptr ? nullptr : bench->current_run();
  return run == nullptr ? 0 : run->results_number; // a new run has another
}

} // namespace dyncal::services::web
