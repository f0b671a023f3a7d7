#include "report/option_reasons.hpp"

#include <map>

namespace csrbf::app {
namespace {

using Json = nlohmann::ordered_json;
using Reasons = std::map<std::string, std::string>;

constexpr const char* cross_validation = "predicts held-out points best (cross-validation)";

std::string normals_reason(const std::string& used) {
  if (used == "estimated") return "the file has none: estimated from neighbours and oriented consistently outwards";
  if (used == "re-oriented") return "those of the file, some flipped to agree with the others";
  return "the file has them";
}

Reasons reconstruct_reasons(const Json& options) {
  const std::string method = options.value("method", "");
  Reasons reasons{{"normals", normals_reason(options.value("normals", ""))},
                  {"resolution", "cells as large as the smallest detail that the surface can represent"}};
  if (method != "composite") return reasons;
  reasons["method"] = "suits point clouds of any size";
  for (const char* name : {"smoothing", "leaf_size", "centers_per_patch", "normal_weight"})
    reasons[name] = cross_validation;
  return reasons;
}

std::string fit_method_reason(const Json& options) {
  const std::string method = options.value("method", "");
  if (method == "fixed-budget") return "a number of centres was given";
  if (method == "error-bounded") return "a tolerance was given, which local fits alone do not meet";
  if (method == "interpolate") return "few samples without noise: a single system of equations";
  return options["tolerance"].is_null() ? "many samples, or noise: blended local fits"
                                        : "a tolerance was given, which local fits meet";
}

Reasons fit_reasons(const Json& options) {
  const bool one_system = options.value("method", "") == "interpolate";
  return {{"method", fit_method_reason(options)},
          {"kernel", one_system ? "predicts held-out samples best (leave-one-out)" : "the default of the method"},
          {"degree", "chosen together with method and smoothing"},
          {"smoothing", "predicts held-out samples best (cross-validation)"}};
}

std::string shading_reason(const std::string& shading) {
  if (shading == "none") return "the means do not vary over the image enough to matter";
  return shading == "auto" ? "" : "explains most of what constant means leave unexplained";
}

Reasons segment_reasons(const Json& options) {
  const bool edge = options.value("energy", "") == "edge";
  return {
      {"center_spacing", "from the noise of the image: the noisier, the wider"},
      {"support", "the default of the method"},
      {"smoothness", edge ? "contours on edges need it to hold together" : "0, as the centres smooth already"},
      {"window", options.value("window", 0) > 0 ? "separates textures" : "0: keeps details"},
      {"shading", shading_reason(options.value("shading", ""))},
      {"fill_holes", options.value("mode", "") == "local" ? "yes in local mode, whose contour leaves dark spots behind"
                                                          : "only in local mode"}};
}

Reasons reasons_of(const std::string& subcommand, const Json& options) {
  if (subcommand == "reconstruct") return reconstruct_reasons(options);
  if (subcommand == "fit" || (subcommand == "inpaint" && options.contains("tolerance"))) return fit_reasons(options);
  if (subcommand == "segment" || subcommand == "track") return segment_reasons(options);
  return {};
}

std::string found(const Reasons& reasons, const std::string& name) {
  const auto entry = reasons.find(name);
  return entry == reasons.end() ? "" : entry->second;
}

}  // namespace

std::string option_reason(const Json& report, const std::string& option) {
  return found(reasons_of(report["command"], report["options"]), option);
}

std::string option_meaning(const std::string& subcommand, const std::string& option) {
  if (subcommand != "reconstruct") return "";
  return found({{"leaf_size", "largest number of points in a patch"},
                {"overlap", "overlap of neighbouring patches"},
                {"centers_per_patch", "radial basis functions in each patch"},
                {"normal_weight", "weight of the normals relative to the points"}},
               option);
}

}  // namespace csrbf::app
