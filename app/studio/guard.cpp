#include "studio/guard.hpp"

#include <array>
#include <random>

namespace csrbf::app {

std::string random_token() {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  constexpr int length = 32;  // 192 bits
  std::random_device source;  // getrandom or /dev/urandom
  std::string token;
  for (int i = 0; i < length; ++i) token += letters[source() % letters.size()];
  return token;
}

bool is_local_request(const RequestOrigin& from, int port) {
  const std::string place = ":" + std::to_string(port);
  for (const char* name : {"127.0.0.1", "localhost"}) {
    if (from.host != name + place) continue;
    const bool from_here = from.origin.empty() || from.origin == "http://" + std::string(name) + place;
    // "none": typed into the address bar, or opened by the program.
    return from_here && (from.site.empty() || from.site == "same-origin" || from.site == "none");
  }
  return false;
}

const char* path_below_token(const std::string& path, std::string_view token) {
  if (path.size() < token.size() + 2 || path[0] != '/' || path[token.size() + 1] != '/') return nullptr;
  unsigned different = 0;
  for (std::size_t i = 0; i < token.size(); ++i)
    different |= static_cast<unsigned char>(path[i + 1]) ^ static_cast<unsigned char>(token[i]);
  return different == 0 ? path.c_str() + token.size() + 2 : nullptr;
}

}  // namespace csrbf::app
