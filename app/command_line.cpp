#include "command_line.hpp"

#include "commands/command_flags.hpp"

#include "csrbf/core/joined.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/gdal/gdal.hpp"
#include "csrbf/io/optional_formats.hpp"

#include <algorithm>
#include <functional>
#include <iostream>
#include <map>
#include <memory>

namespace csrbf::app {
namespace {

// The argument, quoted for a shell where needed.
std::string shell_word(const std::string& argument) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("-_./:,=+@%").find(c) != std::string_view::npos;
  };
  if (!argument.empty() && std::all_of(argument.begin(), argument.end(), is_plain)) return argument;
  std::string quoted = "'";
  for (const char c : argument) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

// The program's arguments: one struct per command, of which the parsed one is returned.
class Parser {
 public:
  Parser() : app_("Smooth functions and surfaces from scattered data and images", "csrbf") {
    app_.set_version_flag("-V,--version", "csrbf " CSRBF_VERSION,
                          "print the version; followed by --verbose, the optional parts too");
    app_.set_help_flag("-h,--help", "print this help; csrbf COMMAND --help describes a command");
    app_.require_subcommand(1);
    app_.formatter(help_formatter());
    app_.footer("Example:\n  csrbf reconstruct bunny.xyz -o bunny.ply");
    add<ReconstructCommand>("reconstruct", "Turn a point cloud into a watertight mesh",
                            "csrbf reconstruct scan.ply -o mesh.ply --model scan.csrbf --report report.html");
    add<EstimateNormalsCommand>("estimate-normals", "Estimate and orient the normals of points",
                                "csrbf estimate-normals scan.xyz -o oriented.ply");
    add<PolygonizeCommand>("polygonize", "Turn a saved model into a mesh",
                           "csrbf polygonize scan.csrbf -o fine.ply --resolution 512");
    add<RenderCommand>("render", "Draw a picture of a model or mesh",
                       "csrbf render scan.csrbf -o scan.png --view 290,15 --color mean-curvature");
    add<CurvatureCommand>("curvature", "Compute the curvature of a model and its ridge and valley lines",
                          "csrbf curvature scan.csrbf -o curved.ply --ridges lines.ply");
    add<CombineCommand>("combine", "Unite, intersect, subtract or blend models",
                        "csrbf combine blend body.csrbf head.csrbf -o statue.csrbf --radius 0.03");
    add<FitCommand>("fit", "Fit a smooth function to scattered samples",
                    "csrbf fit soundings.csv -o depth.csrbf --coordinates x,y --values depth --report report.json");
    add<EvaluateCommand>("evaluate", "Evaluate a fitted function at points or on a grid",
                         "csrbf evaluate depth.csrbf -o depth.npy --grid 800,600 --bounds 0:4,0:3");
    add<InpaintCommand>("inpaint", "Fill missing pixels of an image",
                        "csrbf inpaint photo.png -o filled.png --mask scratches.png");
    add<SegmentCommand>("segment", "Segment an image by level sets",
                        "csrbf segment head.nii.gz -o brain.nii.gz --mode local --init sphere:12,-8,30,10");
    add<TrackCommand>("track", "Segment an image sequence, frame by frame",
                      "csrbf track cine.nii.gz -o beat --mode local --init sphere:80,72,20 --report beat.json");
    add<CompareCommand>("compare", "Measure how meshes, points or label images differ",
                        "csrbf compare mesh.ply reference.ply --report comparison.json");
    add<InfoCommand>("info", "Describe a file of points, an image, a mesh or a model", "csrbf info scan.ply");
    add<StudioCommand>("studio", "Work in the browser: open files, run commands, look at the results",
                       "csrbf studio scan.ply");
    for (CLI::Option* option : app_.get_options()) option->group("Flags");
    add_installed_texts();
  }

  std::optional<CommandLine> parse(std::vector<std::string> arguments);

 private:
  template <class AnyCommand>
  void add(const std::string& name, const std::string& what, const std::string& example) {
    const auto command = std::make_shared<AnyCommand>();
    CommandFlags flags(app_, common_, name, what, example);
    declare(flags, *command);
    flags.add_common();
    taken_[name] = [command] { return Command(*command); };
  }
  void add_installed_texts();
  [[nodiscard]] std::vector<std::string> command_names() const;

  CLI::App app_;
  CommonOptions common_;
  std::map<std::string, std::function<Command()>> taken_;  // what was parsed, by command
};

// Texts that the installation writes or other programs ask for; the empty group hides these flags.
void Parser::add_installed_texts() {
  const auto print = [](const std::string& text) {
    write_file("-", text);
    throw CLI::Success();
  };
  app_.add_flag_callback("--print-usage", [=, this] { print(usage_json(usage_of(app_))); })->group("");
#ifndef __EMSCRIPTEN__  // pages install nothing
  for (CLI::App* subcommand : app_.get_subcommands([](const CLI::App* v) { return is_slicer_module(v->get_name()); }))
    subcommand->add_flag_callback("--xml", [=] { print(slicer_module(usage_of(*subcommand))); })->group("");
  app_.add_flag_callback("--print-man", [=, this] { print(man_page(usage_of(app_))); })->group("");
  app_.add_option_function<std::string>(
          "--print-completion", [=, this](const std::string& shell) { print(completion(usage_of(app_), shell)); })
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->group("");
#endif
}

std::vector<std::string> Parser::command_names() const {
  std::vector<std::string> names;
  for (const auto& [name, take] : taken_) names.push_back(name);
  return names;
}

// Before CLI11 complains about what is missing because of them.
void refuse_unknown_flags(const CLI::App& subcommand, const std::vector<std::string>& arguments) {
  std::vector<std::string> known;
  for (const CLI::Option* option : subcommand.get_options())
    if (!option->get_group().empty())  // else hidden
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  for (const std::string& argument : arguments) {
    if (argument == "--") return;
    const std::string flag = argument.substr(0, argument.find('='));
    if (!flag.starts_with("--") || subcommand.get_option_no_throw(flag) != nullptr) continue;
    const std::string name = "csrbf " + subcommand.get_name();
    throw UsageError("unknown flag " + flag + "; " + did_you_mean(flag, known) + name + " --help lists them");
  }
}

// CLI11 takes the next flag for the value of one that has none.
void refuse_flags_without_value(const CLI::App& subcommand, const std::vector<std::string>& arguments) {
  const auto option_of = [&](const std::string& argument) -> const CLI::Option* {
    return argument.size() > 1 && argument.starts_with('-') ? subcommand.get_option_no_throw(argument) : nullptr;
  };
  for (std::size_t i = 0; i + 1 < arguments.size() && arguments[i] != "--"; ++i) {
    const CLI::Option* const option = option_of(arguments[i]);
    if (option == nullptr || option->get_items_expected_min() == 0) continue;
    if (option_of(arguments[i + 1]) != nullptr)
      throw UsageError(arguments[i] + " needs a value, " + option->get_type_name() + "; " + arguments[i + 1] +
                       " follows it");
    ++i;
  }
}

// What this build can do beyond what every build can.
std::string optional_parts() {
  const std::string gdal = gdal_version();
  std::string text;
  for (const OptionalPart& part : optional_formats())
    text += std::string(part.is_there ? "with" : "without") + " " + part.name + ": " + part.what + "\n";
  return text + (gdal.empty() ? "without GDAL" : "with GDAL " + gdal) +
         ": .asc .nc .hgt .grd, .gpkg .shp .geojson .fgb, all reference systems\n";
}

// The command line without the flag by which the studio starts commands.
std::string as_typed(const std::vector<std::string>& arguments) {
  std::string text = "csrbf";
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == job_flag)
      ++i;
    else
      text += " " + shell_word(arguments[i]);
  }
  return text;
}

// CLI11 says "Could not convert: --centers = 1e3" and does not say why.
std::string expected_number(std::string text) {
  const std::size_t colon = text.find(": "), sign = text.find(" = ");
  if (colon == std::string::npos || sign == std::string::npos || sign < colon) return text;
  const std::string value = text.substr(sign + 3);
  return text.substr(colon + 2, sign - colon - 2) + " " + value + ": expected a " +
         (parse_number(value) ? "whole number" : "number");
}

// "csrbf help fit" is "csrbf fit --help".
void rewrite_help(std::vector<std::string>& arguments) {
  if (arguments.front() != "help") return;
  arguments.erase(arguments.begin());
  arguments.emplace_back("--help");
}

std::optional<CommandLine> Parser::parse(std::vector<std::string> arguments) {
  if (arguments.empty()) throw UsageError("a command is required; csrbf --help lists them");
  if (arguments.front() == "--version" || arguments.front() == "-V") {
    std::cout << "csrbf " CSRBF_VERSION "\n";
    if (arguments.size() > 1 && (arguments[1] == "--verbose" || arguments[1] == "-v")) std::cout << optional_parts();
    return std::nullopt;
  }
  rewrite_help(arguments);
  const bool is_subcommand = !arguments.front().empty() && arguments.front().front() != '-';
  const std::string first = is_subcommand ? arguments.front() : "";
  const auto names_it = [&](const CLI::App* subcommand) { return subcommand->get_name() == first; };
  if (is_subcommand && app_.get_subcommands(names_it).empty())
    throw UsageError("unknown command " + in_quotes(first) + "; " + did_you_mean(first, command_names()) +
                     "csrbf --help lists them");
  if (is_subcommand) {
    refuse_unknown_flags(*app_.get_subcommand(first), arguments);
    refuse_flags_without_value(*app_.get_subcommand(first), arguments);
  }
  common_.command = as_typed(arguments);
  try {
    std::reverse(arguments.begin(), arguments.end());
    app_.parse(std::move(arguments));
  } catch (const CLI::Success& asked) {
    app_.exit(asked, std::cout, std::cerr);
    return std::nullopt;
  } catch (const CLI::ConversionError& error) {
    throw UsageError(expected_number(error.what()));
  } catch (const CLI::ParseError& error) {
    const std::string name = first.empty() ? "csrbf" : "csrbf " + first;
    throw UsageError(std::string(error.what()) + "\nTry " + name + " --help");
  }
  const CLI::App* subcommand = app_.get_subcommand(first);
  for (const CLI::Option* option : subcommand->get_options()) {
    const std::vector<std::string> results = option->results();
    common_.values.insert(common_.values.end(), results.begin(), results.end());
    if (!option->get_lnames().empty() && !option->get_group().empty())
      common_.flags.push_back({option->get_lnames().front(), option->get_description(), option->count() > 0,
                               option->count() > 0 ? CLI::detail::join(results, " ") : "",
                               option->get_group() == common_group});
  }
  return CommandLine{first, common_, taken_.at(first)()};
}

// "--orient viewpoint 0,0,9" is one value of two words.
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

}  // namespace csrbf::app
