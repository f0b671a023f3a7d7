#include "command_line.hpp"

#include "completion.hpp"
#include "man_page.hpp"

#include "csrbf/io/text.hpp"
#include "csrbf/version.hpp"

#include <CLI/CLI.hpp>

#include <array>
#include <iostream>

namespace csrbf::app {
namespace {

constexpr const char* point_formats = ".ply .xyz .pts .txt .csv .obj .off .npy, or - for text on standard input";
constexpr const char* mesh_formats = ".ply .obj .off .stl";

// One line per flag with its kind of value, its description wrapped and its default behind it.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() {
    column_width(name_width);
    label("Positionals", "Arguments");
  }

 private:
  static constexpr std::size_t name_width = 28;
  static constexpr std::size_t text_width = 100 - name_width;

  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    std::string name = CLI::Formatter::make_option_name(option, is_positional);
    const std::size_t value = name.find("{false}");
    return name.substr(0, value);
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    // The description says what matters of the checks.
    const std::string form = value_form(*option);
    return form.empty() ? "" : " " + form;
  }

  std::string make_option_desc(const CLI::Option* option) const override {
    std::string text = option->get_description();
    if (!option->get_default_str().empty()) text += " (default: " + option->get_default_str() + ")";
    std::string wrapped;
    std::size_t column = 0;
    std::string_view rest = text;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
      const bool breaks = column > 0 && column + 1 + word.size() > text_width;
      if (column > 0) wrapped += breaks ? '\n' : ' ';
      column = breaks ? word.size() : column + (column > 0 ? 1 : 0) + word.size();
      wrapped += word;
    }
    return wrapped;
  }

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::string text = make_description(app) + make_usage(app, std::move(name)) + make_positionals(app);
    for (const std::string& group : app->get_groups()) {
      const auto members = app->get_options([&](const CLI::Option* option) {
        return option->get_group() == group && option->nonpositional() && !group.empty();
      });
      if (!members.empty()) text += make_group(group, false, members);
    }
    return text + make_subcommands(app, mode) + "\n" + make_footer(app);
  }

  std::string make_usage(const CLI::App* app, std::string name) const override {
    std::string usage = "\nUsage: " + (name.empty() ? app->get_name() : name);
    for (const CLI::Option* option : app->get_options())
      if (option->get_positional()) usage += " " + option->get_name(true);
    if (app->get_option_no_throw("--output") != nullptr) usage += " -o FILE";
    return usage + (app->get_subcommands({}).empty() ? " [FLAGS]\n" : " VERB ...\n");
  }
};

// A verb of the program with its flags bound to one of the command structs.
class Verb {
 public:
  Verb(CLI::App& parent, CommonOptions& common, const std::string& name, const std::string& what,
       const std::string& example)
      : app_(*parent.add_subcommand(name, what)), common_(common) {
    app_.footer("Example:\n  " + example);
    app_.set_help_flag();
    app_.group("Verbs");
  }

  template <class Value>
  void argument(const std::string& name, Value& value, const std::string& what) {
    app_.add_option(name, value, what)->required()->type_name("FILE");
  }
  void output(std::string& value, const std::string& what) {
    app_.add_option("-o,--output", value, what)->required()->type_name("FILE")->group(flag_group);
  }
  /// A flag with a value; `shown_default` says what happens without it.
  template <class Value>
  CLI::Option* flag(const std::string& name, Value& value, const std::string& type, const std::string& shown_default,
                    const std::string& what) {
    return app_.add_option("--" + name, value, what)->type_name(type)->default_str(shown_default)->group(flag_group);
  }
  void toggle(const std::string& names, bool& value, const std::string& what) {
    app_.add_flag(names, value, what)->group(flag_group);
  }

  /// The flags of every verb, last in the help.
  void add_common() {
    constexpr int most_threads = 4096;
    app_.add_option("--threads", common_.threads, "threads to use")
        ->type_name("N")
        ->default_str("all cores")
        ->check(CLI::Range(1, most_threads))
        ->group(common_group);
    app_.add_option("--report", common_.report, "write options, results, times and warnings as JSON")
        ->type_name("FILE")
        ->group(common_group);
    app_.add_option("--progress", common_.progress, "show the progress on standard error; auto: on a terminal")
        ->type_name("auto|always|never")
        ->default_str("auto")
        ->check(CLI::IsMember({"auto", "always", "never"}))
        ->group(common_group);
    app_.add_flag("-q,--quiet", common_.quiet, "print errors only")->group(common_group);
    app_.add_flag("-v,--verbose", common_.verbose, "print the options used and the times too")->group(common_group);
    app_.set_version_flag("--version", "csrbf " CSRBF_VERSION, "print the version")->group(common_group);
    app_.set_help_flag("-h,--help", "print this")->group(common_group);
  }

 private:
  static constexpr const char* flag_group = "Flags";
  static constexpr const char* common_group = "Common flags";

  CLI::App& app_;
  CommonOptions& common_;
};

// The program's arguments: one struct per verb, of which the parsed one is taken.
class Parser {
 public:
  Parser() : app_("Smooth functions and surfaces from scattered data", "csrbf") {
    app_.set_version_flag("--version", "csrbf " CSRBF_VERSION, "print the version");
    app_.set_help_flag("-h,--help", "print this; csrbf VERB --help says more about a verb");
    app_.require_subcommand(1);
    app_.formatter(std::make_shared<HelpFormatter>());
    app_.footer("Example:\n  csrbf reconstruct bunny.xyz -o bunny.ply");
    add_reconstruct();
    add_estimate_normals();
    add_polygonize();
    add_render();
    add_compare();
    add_info();
    for (CLI::Option* option : app_.get_options()) option->group("Flags");
    add_installed_texts();
  }

  std::optional<CommandLine> parse(std::vector<std::string> arguments);

 private:
  void add_reconstruct();
  void add_estimate_normals();
  void add_polygonize();
  void add_render();
  void add_compare();
  void add_info();
  void add_installed_texts();

  Verb verb(const std::string& name, const std::string& what, const std::string& example) {
    return Verb(app_, common_, name, what, example);
  }

  CLI::App app_;
  CommonOptions common_;
  ReconstructCommand reconstruct_;
  EstimateNormalsCommand estimate_normals_;
  PolygonizeCommand polygonize_;
  RenderCommand render_;
  CompareCommand compare_;
  InfoCommand info_;
};

void Parser::add_reconstruct() {
  ReconstructCommand& c = reconstruct_;
  Verb v = verb("reconstruct", "Turn a point cloud into a watertight mesh",
                "csrbf reconstruct scan.ply -o mesh.ply --model scan.csrbf --report report.json");
  v.argument("POINTS", c.input, std::string("points to read: ") + point_formats);
  v.output(c.output, std::string("mesh to write: ") + mesh_formats);
  v.flag("method", c.method, "NAME", "auto", "auto or composite (partition of unity with an RBF residual)");
  v.flag("normals", c.normals, "auto|file|estimate", "auto",
         "auto: those of the file if it has any, turned outwards where they contradict each other; file: as they are; "
         "estimate: always estimated")
      ->check(CLI::IsMember({"auto", "file", "estimate"}));
  v.flag("centers", c.centers, "N", "from the data", "budget of RBF centres")->check(CLI::PositiveNumber);
  v.flag("tolerance", c.tolerance, "E", "none",
         "largest distance from an input point to the surface, as a fraction of the bounding-box diagonal, outliers "
         "aside")
      ->check(CLI::PositiveNumber);
  v.flag("smoothing", c.smoothing, "auto|none|L", "auto", "how much noise to smooth away; larger is smoother");
  v.flag("resolution", c.resolution, "N", "from the sampling", "cells of the mesh along the longest side")
      ->check(CLI::Range(1, 4096));
  v.flag("trim", c.trim, "T", "none",
         "drop surface further than T local point spacings from the data; none: watertight");
  v.flag("model", c.model, "FILE", "", "save the implicit surface: .csrbf");
  v.add_common();
}

void Parser::add_estimate_normals() {
  EstimateNormalsCommand& c = estimate_normals_;
  Verb v = verb("estimate-normals", "Estimate and orient the normals of points",
                "csrbf estimate-normals scan.xyz -o oriented.ply");
  v.argument("POINTS", c.input, std::string("points to read: ") + point_formats);
  v.output(c.output, "points to write with their normals: the same formats");
  v.flag("neighbors", c.neighbors, "K", "12", "points that each normal is estimated from")->check(CLI::Range(3, 1000));
  v.flag("orient", c.orient, "HOW", "consistent",
         "consistent: outwards, as neighbours agree; viewpoint X,Y,Z: towards the scanner; none: either way");
  v.add_common();
}

void Parser::add_polygonize() {
  PolygonizeCommand& c = polygonize_;
  Verb v =
      verb("polygonize", "Make a mesh of a saved model", "csrbf polygonize scan.csrbf -o fine.ply --resolution 512");
  v.argument("MODEL", c.input, "model to read: .csrbf");
  v.output(c.output, std::string("mesh to write: ") + mesh_formats);
  v.flag("resolution", c.resolution, "N", "from the model", "cells along the longest side")->check(CLI::Range(1, 4096));
  v.flag("level", c.level, "V", "0", "the surface where the model has this value; positive values are inside");
  v.toggle("--refine,!--no-refine", c.refine, "move the vertices onto the surface (this is the default)");
  v.add_common();
}

void Parser::add_render() {
  RenderCommand& c = render_;
  Verb v = verb("render", "Draw a picture of a model or mesh",
                "csrbf render scan.csrbf -o scan.png --view 290,15 --color mean-curvature");
  v.argument("INPUT", c.input, std::string("model (.csrbf) or mesh to read: ") + mesh_formats);
  v.output(c.output, "picture to write: .png");
  v.flag("size", c.size, "WxH", c.size, "size in pixels");
  v.flag("view", c.view, "AZIMUTH,ELEVATION", c.view, "direction to look from, degrees: about +z from +x, then up");
  v.flag("up", c.up, "x|y|z", c.up, "axis that points up")->check(CLI::IsMember({"x", "y", "z"}));
  v.flag("color", c.color, "NAME", "plain",
         "plain, normal, mean-curvature, gaussian-curvature, or error:REFERENCE (a mesh)");
  v.add_common();
}

void Parser::add_compare() {
  CompareCommand& c = compare_;
  Verb v = verb("compare", "Measure how a mesh differs from another mesh or from points",
                "csrbf compare mesh.ply reference.ply --report comparison.json");
  v.argument("A", c.first, std::string("mesh: ") + mesh_formats);
  v.argument("B", c.second,
             std::string("reference: a mesh, or points: then the distances go from the points to the mesh only; ") +
                 point_formats);
  v.add_common();
}

void Parser::add_info() {
  Verb v = verb("info", "Say what a file of points, a mesh or a model holds", "csrbf info scan.ply");
  v.argument("FILE", info_.input, "points, mesh or model");
  v.add_common();
}

// What the installation writes beside the program; the empty group hides these flags.
void Parser::add_installed_texts() {
  const auto print = [](const std::string& text) {
    std::cout << text;
    throw CLI::Success();
  };
  app_.add_flag_callback("--print-man", [=, this] { print(man_page(usage_of(app_))); })->group("");
  app_.add_option_function<std::string>(
          "--print-completion", [=, this](const std::string& shell) { print(completion(usage_of(app_), shell)); })
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->group("");
}

std::optional<CommandLine> Parser::parse(std::vector<std::string> arguments) {
  if (arguments.empty()) throw UsageError("a verb is required; csrbf --help lists them");
  const bool is_verb = !arguments.front().empty() && arguments.front().front() != '-';
  const std::string first = is_verb ? arguments.front() : "";
  const auto names_it = [&](const CLI::App* verb) { return verb->get_name() == first; };
  if (is_verb && app_.get_subcommands(names_it).empty())
    throw UsageError("unknown verb " + in_quotes(first) + "; csrbf --help lists them");
  try {
    std::reverse(arguments.begin(), arguments.end());
    app_.parse(std::move(arguments));
  } catch (const CLI::Success& asked) {
    app_.exit(asked, std::cout, std::cerr);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    const std::string name = first.empty() ? "csrbf" : "csrbf " + first;
    throw UsageError(std::string(error.what()) + "\nTry " + name + " --help");
  }
  CommandLine line{first, common_, {}};
  if (first == "reconstruct") line.command = reconstruct_;
  if (first == "estimate-normals") line.command = estimate_normals_;
  if (first == "polygonize") line.command = polygonize_;
  if (first == "render") line.command = render_;
  if (first == "compare") line.command = compare_;
  if (first == "info") line.command = info_;
  return line;
}

// "--orient viewpoint 0,0,9" is one value in two words.
std::vector<std::string> joined_arguments(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  for (std::size_t i = 0; i + 2 < arguments.size(); ++i) {
    if (arguments[i] != "--orient" || arguments[i + 1] != "viewpoint") continue;
    arguments[i + 1] += " " + arguments[i + 2];
    arguments.erase(arguments.begin() + static_cast<std::ptrdiff_t>(i) + 2);
  }
  return arguments;
}

}  // namespace

std::optional<CommandLine> parse_command_line(int argc, char** argv) {
  return Parser().parse(joined_arguments(argc, argv));
}

Eigen::VectorXd parse_numbers(const std::string& text, char separator, Index count, const std::string& flag) {
  Eigen::VectorXd numbers(count);
  std::string_view rest = text;
  for (Index i = 0; i < count; ++i) {
    const std::size_t end = i + 1 < count ? rest.find(separator) : rest.size();
    const auto number = end == std::string_view::npos ? std::nullopt : parse_number(trimmed(rest.substr(0, end)));
    if (!number || !std::isfinite(*number))
      throw UsageError(flag + " " + text + ": expected " + std::to_string(count) + " numbers separated by \"" +
                       separator + "\"");
    numbers[i] = *number;
    rest.remove_prefix(std::min(rest.size(), end + 1));
  }
  return numbers;
}

std::optional<double> parse_word_or_number(const std::string& text, const std::string& word, const std::string& flag) {
  if (text == word) return std::nullopt;
  const std::optional<double> number = parse_number(text);
  if (!number) throw UsageError(flag + " " + text + ": expected \"" + word + "\" or a number");
  return number;
}

}  // namespace csrbf::app
