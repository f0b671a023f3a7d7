#include "csrbf/io/optional_formats.hpp"

#include "csrbf/io/geometry/formats.hpp"
#include "csrbf/io/images/dicom.hpp"
#include "csrbf/io/images/formats.hpp"

namespace csrbf {

std::vector<OptionalPart> optional_formats() {
  return {{"libjpeg", reads_jpeg(), ".jpg .jpeg"},
          {"laz-perf or LASzip", reads_laz(), ".laz, compressed .las, COPC"},
          {"libE57Format", reads_e57(), ".e57"},
          {"GDCM", reads_dicom(), "DICOM files and folders"}};
}

}  // namespace csrbf
