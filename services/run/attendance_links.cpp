#include "services/run/attendance_links.hpp"

#include <utility>

namespace dyncal::inline run {
namespace {

// A Measurement every 2 s and an Excitation every 0.5 s, and half as many again for what changes.
constexpr std::uint64_t measurements_per_hour = 2'700;
constexpr std::uint64_t excitations_per_hour = 10'800;

template <class Message>
void show_next(OneWayChain& chain, Message& message) {
  const auto link = chain.next();
  message.link_number(link ? link->number : 0);
  message.link(link ? to_string(link->link) : "");
}

} // namespace

Expected<AttendanceLinks> AttendanceLinks::draw(std::chrono::hours attendance) {
  const auto hours = static_cast<std::uint64_t>(attendance.count());
  DYNCAL_TRY(auto measurement, OneWayChain::draw(hours * measurements_per_hour));
  DYNCAL_TRY(auto excitation, OneWayChain::draw(hours * excitations_per_hour));
  return AttendanceLinks(std::move(measurement), std::move(excitation));
}

void AttendanceLinks::show(wire::Measurement& measurement) {
  measurement.excitation_anchor(to_string(excitation_.announced()));
  show_next(measurement_, measurement);
}

void AttendanceLinks::show(wire::Excitation& excitation) {
  show_next(excitation_, excitation);
}

} // namespace dyncal::inline run
