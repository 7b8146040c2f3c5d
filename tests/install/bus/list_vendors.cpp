// Prints how many DDS implementations the installed library has, and encodes a message.
#include <iostream>

#include <dyncal/services/bus/bus.hpp>

int main() {
  const dyncal::wire::Command command;
  std::cout << "dds: " << dyncal::bus::vendors_in_this_build().size() << '\n';
  return dyncal::bus::type_support<dyncal::wire::Command>().serialized_size(&command) > 0 ? 0 : 1;
}
