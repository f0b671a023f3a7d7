#pragma once

#include <string>
#include <string_view>

namespace csrbf::app {

/// 32 random letters and digits from the system's source of randomness: who knows them started the studio.
std::string random_token();

/// What a request says about where it comes from.
struct RequestOrigin {
  std::string_view host;    ///< header Host
  std::string_view origin;  ///< header Origin; empty when there is none
  std::string_view site;    ///< header Sec-Fetch-Site; empty when there is none
};

/// Whether a request may be answered by the studio at 127.0.0.1:port: it is meant for this machine by name, so that no
/// other name that somebody lets point to this machine works (DNS rebinding), and no page from elsewhere sent it.
bool is_local_request(const RequestOrigin& from, int port);

/// The rest of the path after "/TOKEN/"; null unless the path begins like that. Takes the same time for all wrong
/// tokens of the right length.
const char* path_below_token(const std::string& path, std::string_view token);

}  // namespace csrbf::app
