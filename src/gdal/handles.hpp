#pragma once

#include <cpl_error.h>
#include <gdal.h>

#include <cstddef>
#include <memory>
#include <string>

namespace csrbf {

// One line: statements of SQL in it are kilobytes long.
inline std::string shortened(const std::string& text) {
  constexpr std::size_t most = 240, head = 80;
  std::string line =
      text.size() <= most ? text : text.substr(0, head) + " ... " + text.substr(text.size() - most + head);
  for (char& c : line)
    if (c == '\n' || c == '\r' || c == '\t') c = ' ';
  return line;
}

// GDAL prints nothing; its first error is the reason of a failure, of which later ones follow.
class Quiet {
 public:
  Quiet() {
    CPLErrorReset();
    CPLPushErrorHandlerEx(note, this);
  }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
  ~Quiet() { CPLPopErrorHandler(); }

  [[nodiscard]] static std::string reason(const std::string& otherwise) {
    const std::string& first = static_cast<Quiet*>(CPLGetErrorHandlerUserData())->first_;
    return "GDAL: " + (first.empty() ? otherwise : shortened(first));
  }

 private:
  static void CPL_STDCALL note(CPLErr kind, CPLErrorNum /*number*/, const char* text) {
    std::string& first = static_cast<Quiet*>(CPLGetErrorHandlerUserData())->first_;
    if (kind >= CE_Failure && first.empty()) first = text;
  }

  std::string first_;
};

struct Close {
  void operator()(void* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<void, Close>;

}  // namespace csrbf
