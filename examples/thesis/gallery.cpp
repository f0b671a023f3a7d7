#include "gallery.hpp"

#include "baselines.hpp"
#include "chapter_5.hpp"
#include "csrbf/core/error.hpp"
#include "dimensions.hpp"
#include "figure_1_1.hpp"
#include "figure_2_1.hpp"
#include "figure_2_4.hpp"
#include "figure_3_1.hpp"
#include "figure_3_10.hpp"
#include "figure_3_14.hpp"
#include "figure_3_16.hpp"
#include "figure_3_4.hpp"
#include "figure_3_9.hpp"
#include "figure_4_1.hpp"
#include "figure_6_1.hpp"
#include "figure_6_10.hpp"
#include "figure_6_17.hpp"
#include "figure_6_21.hpp"
#include "figure_6_4.hpp"
#include "figure_6_6.hpp"
#include "figure_6_8.hpp"
#include "figure_6_9.hpp"
#include "figure_7_1.hpp"
#include "figure_8_1.hpp"
#include "figure_8_10.hpp"
#include "figure_8_2.hpp"
#include "figure_8_4.hpp"
#include "figure_8_6.hpp"
#include "figure_8_8.hpp"
#include "introduction.hpp"
#include "k_space.hpp"
#include "table_2_4.hpp"
#include "table_8_1.hpp"

#include <functional>

namespace csrbf::thesis {
namespace {

struct Work {
  const char* name;
  std::function<Figure(const UserImages&)> compute;
};

std::function<Figure(const UserImages&)> alone(Figure (*figure)()) {
  return [figure](const UserImages&) { return figure(); };
}

const std::vector<Work>& all_work() {
  static const std::vector<Work> all = {
      {"introduction", alone(introduction)},
      {"k-space", alone(k_space)},
      {"chapter-1", alone(baselines)},
      {"figure-1.1", alone(figure_1_1)},
      {"figure-1.2", alone(figure_1_2)},
      {"figure-2.1", alone(figure_2_1)},
      {"figure-2.4", alone(figure_2_4)},
      {"table-2.4", alone(table_2_4)},
      {"figure-3.1", alone(figure_3_1)},
      {"figure-3.4", alone(figure_3_4)},
      {"figure-3.9", alone(figure_3_9)},
      {"figure-3.10", alone(figure_3_10)},
      {"figure-3.14", alone(figure_3_14)},
      {"figure-3.16", alone(figure_3_16)},
      {"dimensions", alone(dimensions)},
      {"figure-4.1", alone(figure_4_1)},
      {"chapter-5", alone(chapter_5)},
      {"figure-6.1", alone(figure_6_1)},
      {"figure-6.3", alone(figure_6_3)},
      {"figure-6.4", alone(figure_6_4)},
      {"figure-6.5", alone(figure_6_5)},
      {"figure-6.6", alone(figure_6_6)},
      {"figure-6.8", alone(figure_6_8)},
      {"figure-6.9", alone(figure_6_9)},
      {"figure-6.10", alone(figure_6_10)},
      {"figure-6.17", alone(figure_6_17)},
      {"figure-6.18", alone(figure_6_18)},
      {"figure-6.21", alone(figure_6_21)},
      {"figure-7.1", alone(figure_7_1)},
      {"figure-8.1", alone(figure_8_1)},
      {"figure-8.2", alone(figure_8_2)},
      {"figure-8.4", alone(figure_8_4)},
      {"figure-8.6", alone(figure_8_6)},
      {"figure-8.8", [](const UserImages& images) { return figure_8_8(images.bone); }},
      {"figure-8.10", [](const UserImages& images) { return figure_8_10(images.ultrasound); }},
      {"table-8.1", alone(table_8_1)}};
  return all;
}

}  // namespace

std::vector<std::string> names() {
  std::vector<std::string> found;
  for (const Work& work : all_work()) found.emplace_back(work.name);
  return found;
}

Figure compute(const std::string& name, const UserImages& images) {
  std::string known;
  for (const Work& work : all_work()) {
    if (name == work.name) return work.compute(images);
    known += (known.empty() ? "" : ", ") + std::string(work.name);
  }
  throw InvalidInput("thesis figure " + name + ": there is none of this name; there are " + known);
}

}  // namespace csrbf::thesis
