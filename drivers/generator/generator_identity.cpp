#include "drivers/generator/generator_identity.hpp"

#include <chrono>

#include "drivers/link/scpi_connection.hpp"
#include "drivers/link/stop_signal.hpp"

namespace dyncal::drivers::generator {
namespace {

// It may be busy with another connection, or not be there.
constexpr std::chrono::milliseconds limit{1500};

} // namespace

Expected<std::string> read_identity(const std::string& address) {
  const StopSignal never_raised;
  DYNCAL_TRY(auto connection,
             ScpiConnection::connect("generator", address, limit, never_raised, limit));
  return connection.query("*IDN?");
}

} // namespace dyncal::drivers::generator
