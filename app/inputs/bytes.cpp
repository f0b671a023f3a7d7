#include "inputs/bytes.hpp"

#include "common.hpp"

#include "csrbf/io/files/text.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace csrbf::app {
namespace {

constexpr std::array<std::pair<const char*, double>, 6> units = {
    {{"MB", 1e6}, {"GB", 1e9}, {"TB", 1e12}, {"MiB", 1048576.0}, {"GiB", 1073741824.0}, {"TiB", 1099511627776.0}}};

}  // namespace

std::size_t parse_bytes(const std::string& text, const std::string& flag) {
  const std::size_t end = text.find_first_not_of("0123456789.");
  const std::string unit = end == std::string::npos ? "" : text.substr(end);
  const auto* const known = std::find_if(units.begin(), units.end(), [&](const auto& u) { return unit == u.first; });
  const auto number = parse_number(text.substr(0, end));
  if (known == units.end() || !number || !(*number > 0))
    throw UsageError(flag + " " + text + ": expected a size such as 2GB, 1500MB or 2GiB");
  constexpr double most = 1e18;  // that fits the integer
  return static_cast<std::size_t>(std::min(most, *number * known->second));
}

}  // namespace csrbf::app
