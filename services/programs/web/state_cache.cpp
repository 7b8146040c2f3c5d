#include "services/programs/web/state_cache.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/views/live/laboratory_json.hpp"
#include "services/views/live/run_figures.hpp"
#include "services/views/live/run_json.hpp"
#include "services/views/report/picture_json.hpp"

namespace dyncal::inline programs::web {
namespace {

using Json = nlohmann::ordered_json;

Json milliseconds(std::int64_t utc_ns) {
  return utc_ns == 0 ? Json(nullptr) : Json(static_cast<double>(utc_ns) / 1e6);
}

Json runs_json(const network::Bench& bench) {
  Json runs = Json::array();
  for (const auto& [name, run] : bench.runs) {
    runs.push_back({{"run", name},
                    {"planned_utc_ms", milliseconds(run.time_utc_ns())},
                    {"state", network::to_string(run.state())}});
  }
  return runs;
}

} // namespace

const network::Run* find_run(const network::Bench* bench, const std::string& run) {
  if (bench == nullptr || run.empty()) {
    return bench == nullptr ? nullptr : bench->current_run();
  }
  const auto found = bench->runs.find(run);
  return found == bench->runs.end() ? nullptr : &found->second;
}

const StateCache::Made* StateCache::find(const TextKey& key) {
  const auto found = texts_.find(key);
  if (found == texts_.end()) {
    return nullptr;
  }
  found->second.asked = laboratory_.clock().now();
  return &found->second;
}

Text StateCache::young(const TextKey& key) {
  const Made* made = find(key);
  const bool is_young = made != nullptr && laboratory_.clock().now() - made->when < text_age;
  return is_young ? made->text : nullptr;
}

Text StateCache::keep(const TextKey& key, const Json& json, std::uint64_t number) {
  std::string whole = json_text(json);
  whole.shrink_to_fit(); // it has grown by doubling
  Text text = std::make_shared<const std::string>(std::move(whole));
  texts_.erase(key);
  make_room(text->size());
  const bus::Clock::Instant now = laboratory_.clock().now();
  texts_[key] = Made{text, now, number, now};
  return text;
}

void StateCache::make_room(std::size_t needed) {
  while (!texts_.empty() && (texts_.size() >= max_texts || bytes() + needed > max_bytes)) {
    texts_.erase(
        std::ranges::min_element(texts_, {}, [](const auto& held) { return held.second.asked; }));
  }
}

void StateCache::drop_what_is_not_shown() {
  const bus::Clock::Instant now = laboratory_.clock().now();
  std::erase_if(texts_, [&](const auto& held) {
    const auto& [key, made] = held;
    if (now - made.asked >= forgotten_after) {
      return true;
    }
    return !key.run.empty() && find_run(laboratory_.bench(key.bench), key.run) == nullptr;
  });
}

std::size_t StateCache::bytes() const {
  std::size_t sum = 0;
  for (const auto& [key, made] : texts_) {
    sum += made.text->size();
  }
  return sum;
}

StateCache::Held StateCache::held() const {
  const std::lock_guard lock(mutex_);
  return {texts_.size(), bytes()};
}

Text StateCache::laboratory() {
  const std::lock_guard lock(mutex_);
  const TextKey key{"laboratory", "", "", ""};
  if (Text text = young(key)) {
    return text;
  }
  Json json = live::laboratory_json(laboratory_);
  add_daemon_(json);
  return keep(key, json);
}

Text StateCache::bench(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const network::Bench* bench = laboratory_.bench(name);
  if (bench == nullptr) {
    return nullptr;
  }
  const TextKey key{"bench", name, "", ""};
  if (Text text = young(key)) {
    return text;
  }
  return keep(key, live::bench_json(laboratory_, *bench));
}

Text StateCache::results(const std::string& name, const std::string& run_name,
                         const AddFiles& add_files) {
  const std::lock_guard lock(mutex_);
  const network::Bench* bench = laboratory_.bench(name);
  const network::Run* run = find_run(bench, run_name);
  if (run == nullptr) {
    return nullptr;
  }
  const TextKey key{"run", name, run->name, ""};
  const std::uint64_t number = run->results_number;
  const Made* made = find(key);
  const bool is_over = run->is_over(); // then files come and go
  if (made != nullptr && made->number == number && (!is_over || young(key))) {
    return made->text;
  }
  Json json{{"number", number},
            {"now_utc_ms", milliseconds(laboratory_.clock().utc_now_ns())},
            {"bench", name}};
  json.update(live::run_json(*bench, *run));
  json["runs"] = runs_json(*bench);
  add_files(run->name, json);
  return keep(key, json, number);
}

Text StateCache::figures(const std::string& name, const std::string& run_name,
                         const std::string& channel, dyncal::figures::ErrorBars error_bars) {
  const std::lock_guard lock(mutex_);
  const network::Bench* bench = laboratory_.bench(name);
  const network::Run* run = find_run(bench, run_name);
  if (run == nullptr) {
    return nullptr;
  }
  const std::string bars =
      error_bars == dyncal::figures::ErrorBars::none ? "none" : symbol_of(error_bars);
  const TextKey key{"figures " + bars, name, run->name, channel};
  const std::uint64_t number = run->results_number;
  const Made* made = find(key);
  if (made != nullptr && made->number == number) {
    return made->text;
  }
  Json pictures = Json::array();
  for (const dyncal::figures::Figure& figure :
       live::run_figures(*bench, *run, channel, error_bars)) {
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

std::uint64_t StateCache::number() const {
  const std::lock_guard lock(mutex_);
  return laboratory_.number();
}

std::uint64_t StateCache::results_number(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const network::Run* run = find_run(laboratory_.bench(name), "");
  return run == nullptr ? 0 : run->results_number; // a new run has another
}

} // namespace dyncal::inline programs::web
