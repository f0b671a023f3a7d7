#include "csrbf/core/error.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/samples.hpp"

#include <map>

namespace csrbf {

std::vector<Eigen::Matrix2Xd> read_faults(const std::string& path) {
  const Eigen::MatrixXd values = read_sample_source(path).values;
  const std::string name = display_name(path);
  const Index columns = values.rows();
  if (columns != 2 && columns != 3)
    throw IoError(name +
                  ": faults need two columns of coordinates and, for several, one with the number of the line; "
                  "found " +
                  std::to_string(columns));
  if (!values.allFinite()) throw IoError(name + ": a number is missing or not finite");
  std::vector<Eigen::Matrix2Xd> faults;
  std::map<double, std::vector<Index>> lines;
  for (Index row = 0; row < values.cols(); ++row) lines[columns == 3 ? values(2, row) : 0].push_back(row);
  for (const auto& [number, rows] : lines) {
    if (rows.size() < 2)
      throw IoError(name + ": the line of row " + std::to_string(rows.front() + 1) + " has one vertex; two are needed");
    faults.emplace_back(values(std::vector<Index>{0, 1}, rows));
  }
  return faults;
}

}  // namespace csrbf
