#pragma once

#include "commands/commands.hpp"
#include "help/usage.hpp"

#include "csrbf/io/files/text.hpp"
#include "csrbf/version.hpp"

#include <CLI/CLI.hpp>

#include <cmath>

namespace csrbf::app {

/// A command of the program with its flags bound to one of the command structs.
class CommandFlags {
 public:
  CommandFlags(CLI::App& parent, CommonOptions& common, const std::string& name, const std::string& what,
               const std::string& example)
      : app_(*parent.add_subcommand(name, what)), common_(common) {
    app_.footer("Example:\n  " + example);
    app_.set_help_flag();
    app_.group("Commands");
  }

  template <class Value>
  CLI::Option* argument(const std::string& name, Value& value, const std::string& what) {
    return app_.add_option(name, value, what)->required()->type_name("FILE");
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
  /// A flag whose value is one of the names, which shells complete; the command itself says which others there are.
  CLI::Option* named_flag(const std::string& name, std::string& value, const std::vector<std::string>& names,
                          const std::string& shown_default, const std::string& what) {
    CLI::Option* const option = flag(name, value, "NAME", shown_default, what);
    name_words(*option, names);
    return option;
  }
  /// A flag whose value is above 0.
  template <class Value>
  CLI::Option* positive_flag(const std::string& name, Value& value, const std::string& type,
                             const std::string& shown_default, const std::string& what) {
    const auto check = [name](const std::string& text) {
      const std::optional<double> number = parse_number(text);
      if (!number || !(*number > 0) || std::isinf(*number))
        throw UsageError("--" + name + " " + text + ": must be a positive number");
      return std::string();
    };
    return flag(name, value, type, shown_default, what)->check(CLI::Validator(check, ""));
  }
  void toggle(const std::string& names, bool& value, const std::string& what) {
    app_.add_flag(names, value, what)->group(flag_group);
  }

  /// The flags of every command, last in the help.
  void add_common() {
    constexpr int most_threads = 4096;  // more is a typing error
    app_.add_option("--threads", common_.threads, "threads to use")
        ->type_name("N")
        ->default_str("all cores")
        ->check(CLI::Range(1, most_threads))
        ->group(common_group);
    app_.add_option("--report", common_.reports,
                    "write options, results, times and warnings: .json, or .html for a browser; may be repeated")
        ->type_name("FILE")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->group(common_group);
    app_.add_option(
            "--progress", common_.progress,
            "show progress on standard error; auto: on a terminal only; slicer: on standard output, in the form "
            "that 3D Slicer reads")
        ->type_name("auto|always|never|slicer")
        ->default_str("auto")
        ->check(CLI::IsMember({"auto", "always", "never", "slicer"}))
        ->group(common_group);
    if (app_.get_option_no_throw("--format") == nullptr)
      app_.add_option("--format", common_.format,
                      "format of the input, and of an output without an extension: las, ply, csv, tif and the like")
          ->type_name("NAME")
          ->default_str("by extension, else by content")
          ->group(common_group);
    app_.add_flag("-q,--quiet", common_.quiet, "print errors only")->group(common_group);
    app_.add_flag("-v,--verbose", common_.verbose, "also print the options used and the times")->group(common_group);
    app_.add_option(job_flag, common_.job)->type_name("FILE")->group("");
    app_.set_version_flag("--version", "csrbf " CSRBF_VERSION, "print the version")->group(common_group);
    app_.set_help_flag("-h,--help", "print this help")->group(common_group);
  }

 private:
  static constexpr const char* flag_group = "Flags";

  CLI::App& app_;
  CommonOptions& common_;
};

/// Work in tiles.
inline void add_tile_flags(CommandFlags& v, TileFlags& f) {
  v.flag("memory", f.memory, "SIZE", "all at once",
         "work in tiles that need about so much memory, for instance 2GB, however many points there are");
  v.positive_flag("tile-points", f.points, "N", "by --memory, else 1000000", "points of a tile at most");
  v.flag("tile-folder", f.folder, "DIR", "OUT.tiles",
         "work in tiles and keep finished steps in this folder, from which an interrupted run goes on");
  v.flag("tile-share", f.share, "K/N|auto", "1/1",
         "this is process K of N that work in the same folder, each of them started; auto: as mpirun or srun say");
}

/// Which points of a scanner are used.
inline void add_point_flags(CommandFlags& v, PointFlags& f) {
  v.flag("class", f.classes, "N,N,...", "all",
         "use only points of these classes, as of .las files: 2 is ground, 5 high vegetation, 6 building");
  v.flag("returns", f.returns, "all|first|last|only", "all",
         "use only the first or last returns of the laser, or those that are the only one of their pulse")
      ->check(CLI::IsMember({"all", "first", "last", "only"}));
}

// Declares the command line of each command: its flags, bound to the struct.

void declare(CommandFlags& v, ReconstructCommand& c);
void declare(CommandFlags& v, EstimateNormalsCommand& c);
void declare(CommandFlags& v, PolygonizeCommand& c);
void declare(CommandFlags& v, RenderCommand& c);
void declare(CommandFlags& v, CurvatureCommand& c);
void declare(CommandFlags& v, CombineCommand& c);
void declare(CommandFlags& v, CompareCommand& c);
void declare(CommandFlags& v, InfoCommand& c);
void declare(CommandFlags& v, FitCommand& c);
void declare(CommandFlags& v, EvaluateCommand& c);
void declare(CommandFlags& v, InpaintCommand& c);
void declare(CommandFlags& v, SegmentCommand& c);
void declare(CommandFlags& v, TrackCommand& c);
void declare(CommandFlags& v, StudioCommand& c);

}  // namespace csrbf::app
