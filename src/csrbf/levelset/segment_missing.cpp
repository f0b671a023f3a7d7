#include "csrbf/levelset/segment_missing.hpp"

#include <cmath>
#include <sstream>

namespace csrbf {
namespace {

std::string exactly(const MissingBlock& block) {
  std::ostringstream text;
  text.precision(3);
  text << 100 * block.share << " % of the voxels, which are exactly ";
  text.precision(9);
  text << block.value << ", farther from all others than these are from one another";
  return text.str();
}

}  // namespace

bool may_leave_out(const MissingBlock& block, const SegmentOptions& options, Index voxels) {
  constexpr double least = 100;  // voxels that may have regions; by hand
  return !block.may_be_dark_or_bright && chooses_model(options) && !is_large(options, voxels) && options.seed.empty() &&
         options.seeds.empty() && (1 - block.share) * static_cast<double>(voxels) >= least;
}

std::string left_out_text(const MissingBlock& block) {
  return exactly(block) + ", are left out as missing; if they are not, give nan as the value of missing ones";
}

std::string is_label_text(const MissingBlock& block, int label) {
  return "label " + std::to_string(label) + " is " + exactly(block) +
         ": if they are missing, give that value as the one of missing ones";
}

}  // namespace csrbf
