#include "figure_6_17.hpp"

#include "models.hpp"

#include <algorithm>

namespace csrbf::thesis {

Figure figure_6_5() {
  Figure figure{.name = "figure-6.5",
                .title = "Fig. 6.5: budgets of 15, 100 and 700 centres",
                .text = "Composite method; the kitten (30,000 samples) for the head of Venus."};
  const std::optional<PointCloud> kitten = model("kitten");
  if (!kitten) return without_models(figure);
  Table table{.name = "errors", .columns = {"centers", "rms Taubin"}};
  figure.renders.push_back({"samples", picture(*kitten, {})});
  for (const Index centers : {15, 100, 700}) {
    const MeasuredSurface surface = with_budget(*kitten, "composite", centers);
    const MeshedSurface mesh = meshed(surface);
    table.rows.push_back({static_cast<double>(centers), surface.rms_taubin});
    figure.renders.push_back({std::to_string(centers) + " centres", picture(mesh.mesh, {})});
    figure.claims.push_back({std::to_string(centers) + " centres", "picture",
                             "rms Taubin " + number(surface.rms_taubin, 2) + " of the diagonal, " + mesh.words(),
                             verdict(mesh.whole())});
  }
  figure.tables = {std::move(table)};
  return figure;
}

Figure figure_6_17() {
  Figure figure{.name = "figure-6.17",
                .title = "Figs. 6.14-6.17: more and more centres",
                .text =
                    "Section 6.2: root mean square Taubin distance (6.36) at the samples, in diagonals, and the "
                    "surfaces. For Lucy and the squirrel there is the kitten, for the vessels a generated tree, and "
                    "the dragon is a Chinese one. The published curves start at .016 (dragon .012) in a unit that "
                    "the thesis does not tell."};
  const std::optional<PointCloud> bunny = model("bunny"), kitten = model("kitten"), dragon = model("dragon");
  if (!bunny || !kitten || !dragon) return without_models(figure);
  struct Case {
    const char* name;
    PointCloud cloud;
    Look look;
  };
  const std::vector<Case> cases = {{"dragon", *dragon, {{20, 10}, UpAxis::y}},
                                   {"bunny", *bunny, {}},
                                   {"kitten", *kitten, {}},
                                   {"vessels", vessel_tree(30000), {{-60, 10}, UpAxis::z}}};
  Table table{.name = "rms Taubin", .columns = {"centers"}};
  for (const Index budget : {500, 1000, 2000, 5000, 10000}) table.rows.push_back({static_cast<double>(budget)});
  for (const Case& c : cases) {
    table.columns.emplace_back(c.name);
    bool whole = true;
    std::string words;
    std::vector<double> errors;
    for (auto& row : table.rows) {
      const auto budget = static_cast<Index>(row[0]);
      const MeasuredSurface surface = with_budget(c.cloud, "medial-axis", budget);
      errors.push_back(surface.rms_taubin);
      row.push_back(surface.rms_taubin);
      if (c.name == std::string("bunny") || (budget != 500 && budget != 2000 && budget != 10000)) continue;
      const MeshedSurface mesh = meshed(surface, 160);
      whole = whole && mesh.whole();
      words += (words.empty() ? "" : "; ") + mesh.words();
      figure.renders.push_back(
          {std::string(c.name) + ", " + std::to_string(budget) + " centres", picture(mesh.mesh, c.look)});
    }
    figure.claims.push_back(
        {std::string(c.name) + ": the error falls with the number of centres", "yes",
         "from " + number(errors.front(), 2) + " to " + number(errors.back(), 2) + " of the diagonal",
         verdict(std::is_sorted(errors.rbegin(), errors.rend()))});
    if (words.empty()) continue;
    figure.claims.push_back(
        {std::string(c.name) + ": whole with 500, 2000 and 10,000 centres", "pictures", words, verdict(whole)});
  }
  figure.tables = {std::move(table)};
  return figure;
}

}  // namespace csrbf::thesis
