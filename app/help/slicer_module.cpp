#include "help/usage.hpp"

#include "csrbf/io/files/text.hpp"
#include "csrbf/io/vtk/xml.hpp"
#include "csrbf/version.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <span>

namespace csrbf::app {
namespace {

/// A file among the arguments and flags of a command, and its Slicer parameter: an image, a geometry or any file.
struct SlicerFile {
  std::string_view name;
  std::string_view tag, attributes, channel;
};

constexpr std::string_view plain_image = " fileExtensions=\".nrrd\"";
constexpr std::string_view label_image = " type=\"label\" fileExtensions=\".nrrd\"";
constexpr std::string_view model = " type=\"model\" fileExtensions=\".vtp\"";

constexpr std::array segment_files{SlicerFile{"IMAGE", "image", plain_image, "input"},
                                   SlicerFile{"--output", "image", label_image, "output"},
                                   SlicerFile{"--contour", "geometry", model, "output"},
                                   SlicerFile{"--mask", "image", label_image, "input"},
                                   SlicerFile{"--seeds", "image", label_image, "input"},
                                   SlicerFile{"--table", "file", " fileExtensions=\".csv\"", "output"},
                                   SlicerFile{"--model", "file", " fileExtensions=\".csrbf\"", "output"},
                                   SlicerFile{"--preview", "file", " fileExtensions=\".png\"", "output"}};
constexpr std::array reconstruct_files{SlicerFile{"POINTS", "geometry", model, "input"},
                                       SlicerFile{"--output", "geometry", model, "output"},
                                       SlicerFile{"--model", "file", " fileExtensions=\".csrbf\"", "output"}};
constexpr std::array inpaint_files{SlicerFile{"IMAGE", "image", plain_image, "input"},
                                   SlicerFile{"--output", "image", plain_image, "output"},
                                   SlicerFile{"--mask", "image", label_image, "input"}};

struct SlicerModule {
  std::string_view subcommand, category;
  std::span<const SlicerFile> files;
};

constexpr std::array modules{SlicerModule{"segment", "Segmentation", segment_files},
                             SlicerModule{"reconstruct", "Surface Models", reconstruct_files},
                             SlicerModule{"inpaint", "Filtering", inpaint_files}};

const SlicerModule* find_module(const std::string& subcommand) {
  const auto found =
      std::find_if(modules.begin(), modules.end(), [&](const SlicerModule& m) { return m.subcommand == subcommand; });
  return found == modules.end() ? nullptr : &*found;
}

std::string element(const std::string& tag, std::string_view text) {
  return "<" + tag + ">" + xml_escaped(text) + "</" + tag + ">\n";
}

void make_lower(std::string& name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
}

// "center-spacing" as "Center spacing".
std::string label(std::string name) {
  std::replace(name.begin(), name.end(), '-', ' ');
  make_lower(name);
  name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
  return name;
}

std::string identity(const std::string& name, const std::string& what) {
  std::string identifier = name;
  std::replace(identifier.begin(), identifier.end(), '-', '_');
  return element("name", identifier) + element("label", label(name)) + element("description", what);
}

// Slicer omits empty texts and files, and always passes everything else.
std::string option(const FlagUsage& flag, const std::string& name) {
  const bool has_default_word = std::find(flag.words.begin(), flag.words.end(), flag.shown_default) != flag.words.end();
  const std::optional<double> number = parse_number(flag.shown_default);
  std::string tag = "string", known = element("default", "");
  if (has_default_word && flag.only_words) {
    tag = "string-enumeration";
    known = element("default", flag.shown_default);
    for (const std::string& word : flag.words) known += element("element", word);
  } else if (number) {
    tag = flag.value == "N" ? "integer" : "double";
    known = element("default", flag.shown_default);
    if (!flag.lowest.empty())
      known += "<constraints>\n" + element("minimum", flag.lowest) + element("maximum", flag.highest) +
               element("step", tag == "integer" ? "1" : "0.1") + "</constraints>\n";
  }
  const std::string what =
      flag.shown_default.empty() ? flag.what : flag.what + " (default: " + flag.shown_default + ")";
  return "<" + tag + ">\n" + identity(name, what) + element("longflag", name) + known + "</" + tag + ">\n";
}

std::string file(const SlicerFile& file, const std::string& name, const std::string& what, const std::string& place) {
  const std::string tag(file.tag);
  return "<" + tag + std::string(file.attributes) + ">\n" + identity(name, what) + element("channel", file.channel) +
         place + "</" + tag + ">\n";
}

std::string group(const std::string& title, const std::string& parameters) {
  return "<parameters>\n" + element("label", title) + element("description", title) + parameters + "</parameters>\n";
}

}  // namespace

bool is_slicer_module(const std::string& subcommand) {
  return find_module(subcommand) != nullptr;
}

std::string slicer_module(const Usage& subcommand) {
  const SlicerModule& module = *find_module(subcommand.name);
  const auto find_file = [&](const std::string& name) {
    const auto found =
        std::find_if(module.files.begin(), module.files.end(), [&](const SlicerFile& f) { return f.name == name; });
    return found == module.files.end() ? nullptr : &*found;
  };
  std::string files, options;
  int index = 0;
  for (const ArgumentUsage& argument : subcommand.arguments) {
    std::string name = argument.name;
    make_lower(name);
    files += file(*find_file(argument.name), name, argument.what, element("index", std::to_string(index++)));
  }
  for (const FlagUsage& flag : subcommand.flags) {
    if (flag.common) continue;
    const std::string name = flag.names.back().substr(2);
    if (const SlicerFile* known = find_file("--" + name))
      files += file(*known, name, flag.what, element("longflag", name));
    else
      options += option(flag, name);
  }
  return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<executable>\n" + element("category", module.category) +
         element("title", "csrbf " + subcommand.name) + element("description", subcommand.what + ".") +
         element("version", CSRBF_VERSION) + element("documentation-url", "man:csrbf") + element("license", "MIT") +
         element("contributor", "the csrbf authors") + group("Files", files) + group("Options", options) +
         "</executable>\n";
}

}  // namespace csrbf::app
