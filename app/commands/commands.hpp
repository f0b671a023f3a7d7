#pragma once

#include "inputs/point_selection.hpp"
#include "inputs/tile_flags.hpp"
#include "session.hpp"

#include <variant>

namespace csrbf::app {

// One struct per command: the arguments as typed, of which only the syntax is checked. Empty values mean "not given".

struct ReconstructCommand {
  std::string input, output;
  std::string method = "auto";
  std::string normals = "auto";
  Index centers = 0;
  double tolerance = 0;
  std::string smoothing = "auto";
  PointFlags points;
  int resolution = 0;
  std::string sharp = "auto";
  std::string trim = "none";
  std::string model;
  TileFlags tiles;
};

struct EstimateNormalsCommand {
  std::string input, output;
  PointFlags points;
  Index neighbors = 0;
  std::string orient = "consistent";
};

struct PolygonizeCommand {
  std::string input, output;
  std::string method = "auto";
  int resolution = 0;
  double level = 0;
  double tolerance = 0;
  std::optional<double> persistence;
  bool refine = true;
};

struct RenderCommand {
  std::string input, output;
  std::string size = "800x600";
  std::string view = "30,20";
  std::string up = "z";
  std::string color = "plain";
};

struct CurvatureCommand {
  std::string input, output;
  int resolution = 0;
  std::string ridges;
};

struct CombineCommand {
  std::string operation;
  std::vector<std::string> inputs;
  std::string output;
  std::string blending;
  std::optional<double> radius, sharpness;
};

struct CompareCommand {
  std::string first, second;
};

struct InfoCommand {
  std::string input;
};

/// How a function is fitted.
struct FitFlags {
  std::string method = "auto";
  std::string kernel = "auto";
  std::optional<double> kernel_parameter;
  Index centers = 0;
  double tolerance = 0;
  std::string smoothing = "auto";
  std::optional<int> degree;
  std::string loss = "auto";
  std::string transform = "auto";
  std::string extrapolation = "auto";
};

struct FitCommand {
  std::string input, output;
  FitFlags fit;
  std::string coordinates, values, weights;
  std::string periods;
  std::string sphere, drift, derivatives, faults;
  std::optional<double> missing;
  bool standard_deviation = false;
  PointFlags points;
  TileFlags tiles;
};

struct EvaluateCommand {
  std::string input, output;
  std::string points;
  std::string grid, bounds;
  std::string cell, extent;
  std::string crs;
  std::string like;
  bool gradient = false;
  bool hessian = false;
  bool standard_deviation = false;
  std::string deviation_of = "sample";
  bool labels = false;
  bool float32 = false;
  std::string mask;
  std::string extrapolation;
  std::string levels;
};

struct InpaintCommand {
  std::string input, output;
  std::string mask;
  std::string missing;
  std::string blocks = "auto";
  std::string memory;  ///< a size; empty: not given
  FitFlags fit;
};

/// How an image is segmented.
struct SegmentFlags {
  std::string energy = "auto";
  std::string init = "auto";
  int regions = 2;
  std::optional<double> center_spacing;
  std::optional<double> support;
  std::string kernel = "wendland-c2";
  std::string smoothness = "auto";
  std::optional<int> window;
  std::string shading = "auto";
  double balloon = 0;
  std::string fill_holes = "auto";
  std::string mask;
  std::string mode = "global";
  std::string method = "variational";
  int iterations = 100;
};

struct SegmentCommand : SegmentFlags {
  std::string input, output;
  std::string contour, model, preview;
  bool objects = false;
  std::optional<Index> min_size;
  std::string table;
  std::string channels, missing = "auto";
  std::string seeds, seed_confidence;
};

struct TrackCommand : SegmentFlags {
  std::vector<std::string> inputs;
  std::string output;
  double persistence = 1;
  std::optional<double> motion;
  std::optional<double> prediction;
  int sweeps = 2;
  std::string format, contour;
  bool slices_are_frames = false;
};

struct StudioCommand {
  std::vector<std::string> inputs;
  int port = 0;
  bool no_browser = false;
  std::string folder;
  std::string largest = "4GB";
};

using Command = std::variant<ReconstructCommand, EstimateNormalsCommand, PolygonizeCommand, RenderCommand,
                             CurvatureCommand, CombineCommand, FitCommand, EvaluateCommand, InpaintCommand,
                             CompareCommand, InfoCommand, SegmentCommand, TrackCommand, StudioCommand>;

// What each command does: read, compute, write, and fill the session's report and summary. Throw on failure.

void run(const ReconstructCommand& command, Session& session);
void run(const EstimateNormalsCommand& command, Session& session);
void run(const PolygonizeCommand& command, Session& session);
void run(const RenderCommand& command, Session& session);
void run(const CurvatureCommand& command, Session& session);
void run(const CombineCommand& command, Session& session);
void run(const FitCommand& command, Session& session);
void run(const EvaluateCommand& command, Session& session);
void run(const InpaintCommand& command, Session& session);
void run(const SegmentCommand& command, Session& session);
void run(const TrackCommand& command, Session& session);
void run(const StudioCommand& command, Session& session);
void run(const CompareCommand& command, Session& session);
void run(const InfoCommand& command, Session& session);
void run(const Command& command, Session& session);  ///< whichever it is

}  // namespace csrbf::app
