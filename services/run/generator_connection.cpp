#include "services/run/generator_connection.hpp"

#include <limits>
#include <unistd.h>

#include "drivers/generator/by_hand_generator.hpp"
#include "drivers/generator/scpi_generator.hpp"
#include "services/base/device_error.hpp"

namespace dyncal::inline run {

Expected<GeneratorConnection> connect_generator(const GeneratorSettings& settings,
                                                AskOperator ask) {
  GeneratorConnection connection;
  if (settings.driver == GeneratorDriver::by_hand) {
    connection.generator =
        std::make_unique<drivers::generator::ByHandGenerator>(STDIN_FILENO, std::move(ask));
    return connection;
  }
  DYNCAL_TRY(auto guard, OutputGuard::start(settings.address));
  connection.guard.emplace(std::move(guard));
  auto generator = drivers::generator::ScpiGenerator::connect(
      settings.address,
      settings.maximum_voltage_v.value_or(std::numeric_limits<double>::infinity()));
  if (!generator) {
    connection.guard->dismiss(); // nothing was switched on
    return fail(device_error(generator.error()));
  }
  connection.generator = std::move(*generator);
  return connection;
}

} // namespace dyncal::inline run
