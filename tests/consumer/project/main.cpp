#include <csrbf/core/parallel.hpp>
#include <csrbf/core/types.hpp>
#include <csrbf/version.hpp>

#include <cstdlib>

int main() {
  const csrbf::Points<3> points = csrbf::Points<3>::Random(3, 100);
  const csrbf::Box<3> box = csrbf::bounding_box<3>(points);
  double sum = 0;
  csrbf::parallel_for(1, 1, [&](csrbf::Index, csrbf::Index) { sum = box.diagonal(); });
  return sum > 0 && CSRBF_VERSION[0] != '\0' ? EXIT_SUCCESS : EXIT_FAILURE;
}
