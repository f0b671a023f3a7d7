#pragma once

namespace csrbf {

/// Gives the memory of [begin, end), whose content is no longer needed, back to the system; its owner may still write
/// there and free it. Only whole pages are given back, and none where the system has no call for it.
void discard_bytes(char* begin, char* end);

}  // namespace csrbf
