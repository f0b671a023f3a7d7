#include "help/usage.hpp"

#include "csrbf/io/files/text.hpp"
#include "csrbf/version.hpp"

#include <algorithm>
#include <string_view>

namespace csrbf::app {
namespace {

std::string escaped(std::string_view text) {
  std::string roff;
  for (const char c : text) {
    if (c == '\\')
      roff += "\\e";
    else if (c == '-')
      roff += "\\-";
    else
      roff += c;
  }
  return roff;
}

std::string bold(std::string_view text) {
  return "\\fB" + escaped(text) + "\\fR";
}

std::string italic(std::string_view text) {
  return "\\fI" + escaped(text) + "\\fR";
}

// Running text in lines of bounded length; none may begin with a control character.
std::string paragraph(std::string_view text) {
  constexpr std::size_t width = 78;  // of the source; man reflows it
  std::string roff, line;
  for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) {
    const std::string next = escaped(word);
    if (!line.empty() && line.size() + 1 + next.size() > width) {
      roff += line + "\n";
      line.clear();
    }
    const bool is_control = line.empty() && (next.front() == '.' || next.front() == '\'');
    line += (line.empty() ? "" : " ") + std::string(is_control ? "\\&" : "") + next;
  }
  return roff + line + "\n";
}

std::string section(std::string_view title) {
  return ".SH " + std::string(title) + "\n";
}

std::string item(const std::string& term, std::string_view text) {
  return ".TP\n" + term + "\n" + paragraph(text);
}

std::string command(std::string_view text) {
  return ".PP\n.RS 4\n.EX\n" + escaped(text) + "\n.EE\n.RE\n";
}

std::string synopsis(const Usage& subcommand) {
  std::string roff = ".B csrbf " + escaped(subcommand.name) + "\n";
  for (const ArgumentUsage& argument : subcommand.arguments) roff += italic(argument.name) + "\n";
  for (const FlagUsage& flag : subcommand.flags)
    if (flag.required) roff += bold(flag.names.front()) + " " + italic(flag.value) + "\n";
  return roff + "[" + italic("FLAGS") + "]\n";
}

std::string flag_item(const FlagUsage& flag) {
  std::string term;
  for (const std::string& name : flag.names) term += (term.empty() ? "" : ", ") + bold(name);
  if (!flag.value.empty()) term += " " + italic(flag.value);
  return item(term, flag.shown_default.empty() ? flag.what : flag.what + " (default: " + flag.shown_default + ")");
}

// The flags that every command has, listed once.
std::vector<FlagUsage> common_flags(const Usage& program) {
  std::vector<FlagUsage> common = program.subcommands.front().flags;
  std::erase_if(common, [&](const FlagUsage& flag) {
    return !std::all_of(program.subcommands.begin(), program.subcommands.end(), [&](const Usage& subcommand) {
      return std::any_of(subcommand.flags.begin(), subcommand.flags.end(),
                         [&](const FlagUsage& other) { return other.names == flag.names && other.what == flag.what; });
    });
  });
  return common;
}

std::string command_section(const Usage& subcommand, const std::vector<FlagUsage>& common) {
  std::string roff =
      ".SS " + escaped(subcommand.name) + "\n" + synopsis(subcommand) + ".PP\n" + paragraph(subcommand.what + ".");
  for (const ArgumentUsage& argument : subcommand.arguments) roff += item(italic(argument.name), argument.what);
  for (const FlagUsage& flag : subcommand.flags) {
    const auto is_this = [&](const FlagUsage& other) { return other.names == flag.names; };
    if (std::none_of(common.begin(), common.end(), is_this)) roff += flag_item(flag);
  }
  return roff + ".PP\nExample:\n" + command(subcommand.example);
}

std::string exit_status() {
  return section("EXIT STATUS") + item("0", "Success.") +
         item("1", "No result for valid input, or it could not be written.") + item("2", "Invalid usage or input.") +
         item("130", "Interrupted.") + ".PP\n" + paragraph("Output files appear complete or not at all.");
}

std::string formats() {
  return section("FORMATS") +
         paragraph("The extension of a file determines its format; each command lists the formats of its files.") +
         ".PP\n" +
         paragraph(
             "Text files of points may have a header, comments, and blanks, commas or semicolons between "
             "columns. The first three columns are the coordinates, the next three the normals.") +
         ".PP\n" + paragraph("For text formats, - is standard input or output.");
}

std::string examples() {
  return section("EXAMPLES") + "Turn a point cloud into a mesh and keep the surface as a function:\n" +
         command("csrbf reconstruct bunny.xyz -o bunny.ply --model bunny.csrbf") + ".PP\nDraw it:\n" +
         command("csrbf render bunny.csrbf -o bunny.png --up y --view 20,15") + ".PP\nMake a finer mesh of it:\n" +
         command("csrbf polygonize bunny.csrbf -o fine.ply --resolution 512") +
         ".PP\nFit a function to the columns of a table and evaluate it on a grid:\n" +
         command("csrbf fit soundings.csv -o depth.csrbf") +
         command("csrbf evaluate depth.csrbf -o depth.nrrd --grid 800,600") +
         ".PP\nFill the pixels of an image that a mask marks:\n" +
         command("csrbf inpaint photo.png -o filled.png --mask scratches.png") +
         ".PP\nSegment the organ around a point of a volume, and extract its surface:\n" +
         command(
             "csrbf segment head.nii.gz -o brain.nii.gz --mode local --init sphere:12,-8,30,10 --contour brain.ply");
}

}  // namespace

std::string man_page(const Usage& program) {
  // The date is left empty: it would be that of the build.
  std::string roff = ".TH CSRBF 1 \"\" \"csrbf " CSRBF_VERSION "\" \"User Commands\"\n";
  roff += section("NAME") + "csrbf \\- " + paragraph(program.what) + section("SYNOPSIS");
  for (const Usage& subcommand : program.subcommands)
    roff += (&subcommand == &program.subcommands.front() ? "" : ".br\n") + synopsis(subcommand);
  roff += section("DESCRIPTION") +
          paragraph(
              "csrbf turns scattered points into an implicit surface: a smooth function that is positive inside "
              "an object, negative outside and zero on its surface. It yields watertight meshes, pictures, normals and "
              "curvatures. csrbf also turns scattered samples of any quantity into a smooth function that can be "
              "evaluated anywhere, fills the missing pixels of images, and segments images, volumes and sequences into "
              "regions with smooth boundaries. Each command below does one step.");
  const std::vector<FlagUsage> common = common_flags(program);
  roff += section("COMMANDS");
  for (const Usage& subcommand : program.subcommands) roff += command_section(subcommand, common);
  roff += ".SS Flags of every command\n";
  for (const FlagUsage& flag : common) roff += flag_item(flag);
  return roff + exit_status() + formats() + examples();
}

}  // namespace csrbf::app
