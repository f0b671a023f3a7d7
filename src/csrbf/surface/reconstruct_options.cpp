#include "csrbf/surface/reconstruct_options.hpp"

namespace csrbf {

const char* name_of(NormalSource source) {
  switch (source) {
    case NormalSource::file:
      return "file";
    case NormalSource::estimated:
      return "estimated";
    case NormalSource::reoriented:
      return "re-oriented";
    case NormalSource::within_slices:
      return "within the slices";
  }
  return "";
}

}  // namespace csrbf
