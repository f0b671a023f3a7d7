#pragma once

#include "csrbf/core/types.hpp"

#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

namespace csrbf::app {

/// The command line is malformed.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A flag of the command.
struct FlagUse {
  std::string name;  ///< without the dashes
  std::string what;
  bool given = false;
  std::string value = {};  ///< as typed
  bool common = false;     ///< shared by all commands
};

/// Flags of every command.
struct CommonOptions {
  int threads = 0;                   ///< 0 = all cores
  std::vector<std::string> reports;  ///< files of the report: .json, .html
  std::string progress = "auto";     ///< auto, always, never, slicer
  std::string memory;                ///< a size; empty: no cap
  std::string scratch;               ///< folder for memory beyond the cap; empty: that of the output
  bool quiet = false;
  bool verbose = false;

  std::string command;         ///< as typed
  std::vector<FlagUse> flags;  ///< all flags of the command
};

// One struct per command: the arguments as typed, of which only the syntax is checked. Empty values mean "not given".

struct ReconstructCommand {
  std::string input, output;
  std::string method = "auto";
  std::string normals = "auto";
  Index centers = 0;
  double tolerance = 0;
  std::string smoothing = "auto";
  int resolution = 0;
  std::string trim = "none";
  std::string model;
  bool resume = false;
};

struct EstimateNormalsCommand {
  std::string input, output;
  Index neighbors = 0;
  std::string orient = "consistent";
};

struct PolygonizeCommand {
  std::string input, output;
  std::string method = "marching-cubes";
  int resolution = 0;
  double level = 0;
  double tolerance = 0;
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
  std::string extrapolation = "constant";
};

struct FitCommand {
  std::string input, output;
  FitFlags fit;
  std::string coordinates, values, weights;
  std::string periods;
  bool resume = false;
};

struct EvaluateCommand {
  std::string input, output;
  std::string points;
  std::string grid, bounds;
  std::string like;
  bool gradient = false;
  bool hessian = false;
  bool standard_deviation = false;
  bool labels = false;
  bool float32 = false;
};

struct InpaintCommand {
  std::string input, output;
  std::string mask;
  std::string missing;
  FitFlags fit;
};

/// How an image is segmented.
struct SegmentFlags {
  std::string energy = "chan-vese";
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
};

struct TrackCommand : SegmentFlags {
  std::vector<std::string> inputs;
  std::string output;
  double persistence = 1;
  std::optional<double> motion;
  std::optional<double> prediction;
  int sweeps = 2;
  std::string format;
  bool slices_are_frames = false;
};

using Command = std::variant<ReconstructCommand, EstimateNormalsCommand, PolygonizeCommand, RenderCommand,
                             CurvatureCommand, CombineCommand, FitCommand, EvaluateCommand, InpaintCommand,
                             CompareCommand, InfoCommand, SegmentCommand, TrackCommand>;

struct CommandLine {
  std::string subcommand;
  CommonOptions common;
  Command command;
};

/// Parses the arguments; nothing when they ask for help or the version, which is then printed. Throws UsageError.
std::optional<CommandLine> parse_command_line(int argc, char** argv);

/// `text` as numbers separated by `separator`: exactly `count` of them. Throws UsageError that names `flag`.
Eigen::VectorXd parse_numbers(const std::string& text, char separator, Index count, const std::string& flag);

/// As parse_numbers, for any count.
Eigen::VectorXd parse_list(const std::string& text, char separator, const std::string& flag);

/// The value of --smoothing auto|none|L: nothing, 0 or L. Throws UsageError.
std::optional<double> parse_smoothing(const std::string& text);

/// The value of a flag that takes a word or a number. Throws UsageError when the text is neither.
std::optional<double> parse_word_or_number(const std::string& text, const std::string& word, const std::string& flag);

}  // namespace csrbf::app
