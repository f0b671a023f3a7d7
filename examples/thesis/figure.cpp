#include "figure.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/image.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <sstream>

namespace csrbf::thesis {

void write_figure(const Figure& figure, const std::string& folder) {
  using Json = nlohmann::ordered_json;
  Json json = {{"name", figure.name}, {"title", figure.title}, {"text", figure.text}};
  json["claims"] = Json::array();
  for (const Claim& claim : figure.claims)
    json["claims"].push_back(
        {{"what", claim.what}, {"published", claim.published}, {"ours", claim.ours}, {"verdict", claim.verdict}});
  json["tables"] = Json::object();
  for (const Table& table : figure.tables)
    json["tables"][table.name] = {{"columns", table.columns}, {"rows", table.rows}};
  json["pictures"] = Json::object();
  for (const Picture& picture : figure.pictures)
    json["pictures"][picture.name] = {
        {"width", picture.width},
        {"height", picture.height},
        {"values", std::vector<double>(picture.values.data(), picture.values.data() + picture.values.size())}};
  json["renders"] = Json::array();
  for (std::size_t i = 0; i < figure.renders.size(); ++i) {
    const std::string file = figure.name + "-render-" + std::to_string(i + 1) + ".png";
    write_png(folder + "/" + file, figure.renders[i].image);
    json["renders"].push_back({{"caption", figure.renders[i].caption}, {"file", file}});
  }

  const std::string path = folder + "/" + figure.name + ".json";
  std::ofstream file(path);
  file << json.dump(1) << '\n';
  file.close();
  if (!file) throw IoError(path + ": cannot be written; does the folder exist?");
}

std::string number(double value, int digits) {
  std::ostringstream text;
  text.precision(digits);
  text << value;
  return text.str();
}

double slope(const std::vector<double>& x, const std::vector<double>& y) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double u = std::log(x[i]);
    const double v = std::log(y[i]);
    sx += u, sy += v, sxx += u * u, sxy += u * v;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

}  // namespace csrbf::thesis
