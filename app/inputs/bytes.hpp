#pragma once

#include <cstddef>
#include <string>

namespace csrbf::app {

/// Bytes of a size such as 2GB, 1500MB or 2GiB. Throws UsageError that names `flag`.
std::size_t parse_bytes(const std::string& text, const std::string& flag);

}  // namespace csrbf::app
