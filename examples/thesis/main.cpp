#include "comparators.hpp"
#include "csrbf/core/error.hpp"
#include "dimensions.hpp"
#include "figure_2_4.hpp"
#include "figure_3_14.hpp"
#include "figure_3_16.hpp"
#include "figure_3_4.hpp"
#include "figure_3_9.hpp"
#include "figure_6_10.hpp"
#include "figure_6_17.hpp"
#include "figure_6_21.hpp"
#include "figure_6_4.hpp"
#include "figure_6_6.hpp"
#include "figure_6_8.hpp"
#include "figure_7_1.hpp"
#include "figure_8_10.hpp"
#include "figure_8_2.hpp"
#include "figure_8_4.hpp"
#include "figure_8_6.hpp"
#include "figure_8_8.hpp"
#include "k_space.hpp"
#include "table_2_4.hpp"
#include "table_8_1.hpp"

#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>

namespace {

using csrbf::thesis::Figure;

constexpr const char* usage =
    "usage: csrbf-thesis --out DIR [--only NAME] [--ultrasound FILE] [--bone FILE]\n\n"
    "Computes the numbers of the figures and tables of the thesis (chapters 1 to 3, and 6 to 8) and writes one JSON\n"
    "file each into DIR, with pictures; scripts/thesis_page.py draws them. --ultrasound, --bone: images to segment as\n"
    "well for Figs. 8.10 (in the plane) and 8.8 (in space). --only NAME: one of\n";

struct Work {
  std::string name;
  std::function<Figure()> run;
};

// Image files of the user's, or empty.
struct Inputs {
  std::string ultrasound, bone;
};

std::vector<Work> all_work(const Inputs& inputs) {
  using namespace csrbf::thesis;
  return {{"chapter-1", comparators},
          {"figure-2.4", figure_2_4},
          {"table-2.4", table_2_4},
          {"figure-3.4", figure_3_4},
          {"figure-3.9", figure_3_9},
          {"figure-3.14", figure_3_14},
          {"figure-3.16", figure_3_16},
          {"k-space", k_space},
          {"dimensions", dimensions},
          {"figure-6.4", figure_6_4},
          {"figure-6.5", figure_6_5},
          {"figure-6.6", figure_6_6},
          {"figure-6.8", figure_6_8},
          {"figure-6.10", figure_6_10},
          {"figure-6.17", figure_6_17},
          {"figure-6.18", figure_6_18},
          {"figure-6.21", figure_6_21},
          {"figure-7.1", figure_7_1},
          {"figure-8.2", figure_8_2},
          {"figure-8.4", figure_8_4},
          {"figure-8.6", figure_8_6},
          {"figure-8.8", [=] { return figure_8_8(inputs.bone); }},
          {"figure-8.10", [=] { return figure_8_10(inputs.ultrasound); }},
          {"table-8.1", table_8_1}};
}

int print_usage(int status) {
  std::FILE* out = status == 0 ? stdout : stderr;
  std::fputs(usage, out);
  for (const Work& work : all_work({})) std::fprintf(out, "  %s\n", work.name.c_str());
  return status;
}

int run(const std::string& folder, const std::string& only, const Inputs& inputs) {
  std::filesystem::create_directories(folder);
  bool found = false;
  for (const Work& work : all_work(inputs)) {
    if (!only.empty() && only != work.name) continue;
    found = true;
    const Figure figure = work.run();
    csrbf::thesis::write_figure(figure, folder);
    std::printf("%s\n", figure.title.c_str());
    for (const csrbf::thesis::Claim& claim : figure.claims)
      std::printf("  %s: published %s; ours %s: %s\n", claim.what.c_str(), claim.published.c_str(), claim.ours.c_str(),
                  claim.verdict.c_str());
    std::fflush(stdout);
  }
  return found ? 0 : print_usage(2);
}

}  // namespace

int main(int argc, char** argv) {
  std::string folder, only;
  Inputs inputs;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--help" || argument == "-h") return print_usage(0);
    if (argument == "--out" && i + 1 < argc)
      folder = argv[++i];
    else if (argument == "--only" && i + 1 < argc)
      only = argv[++i];
    else if (argument == "--ultrasound" && i + 1 < argc)
      inputs.ultrasound = argv[++i];
    else if (argument == "--bone" && i + 1 < argc)
      inputs.bone = argv[++i];
    else
      return print_usage(2);
  }
  if (folder.empty()) return print_usage(2);
  try {
    return run(folder, only, inputs);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "csrbf-thesis: %s\n", error.what());
    return 1;
  }
}
