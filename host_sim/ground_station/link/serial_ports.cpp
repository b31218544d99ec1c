// The serial ports of this machine.
#include "host_sim/ground_station/link/serial_ports.h"

#include <algorithm>
#include <system_error>

#include "host_sim/core/name_list.h"

namespace screed {

std::vector<std::string> serial_ports(const std::filesystem::path& devices) {
  // Not ttyS: the kernel makes four of them, whether there is a line behind or not.
  constexpr const char* kKinds[] = {"ttyACM", "ttyAMA", "ttyUSB", "rfcomm"};
  std::vector<std::string> ports;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(devices, error)) {
    const std::string name = entry.path().filename().string();
    const bool is_port = std::any_of(std::begin(kKinds), std::end(kKinds),
                                     [&](const char* kind) { return name.rfind(kind, 0) == 0; });
    if (is_port) ports.push_back(entry.path().string());
  }
  std::sort(ports.begin(), ports.end());
  return ports;
}

std::string no_such_port(const std::filesystem::path& devices) {
  const std::vector<std::string> ports = serial_ports(devices);
  return "no such port; serial ports here: " + (ports.empty() ? "none" : name_list(ports));
}

}  // namespace screed
