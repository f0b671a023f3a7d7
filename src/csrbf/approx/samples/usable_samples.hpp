#pragma once

#include "csrbf/approx/samples/samples.hpp"

#include <optional>
#include <utility>
#include <vector>

namespace csrbf {

/// Samples, and the rows of the ones given where they stand.
template <int Dim>
struct UsableSamples {
  Samples<Dim> samples;
  std::vector<Index> rows;
};

/// Those with a weight above 0 of which no value is `missing`. Throws InvalidInput if there are none. O(n).
template <int Dim>
UsableSamples<Dim> usable_samples(const Samples<Dim>& given, const std::optional<double>& missing) {
  std::vector<Index> rows;
  for (Index i = 0; i < given.size(); ++i)
    if ((!missing || (given.values.row(i).array() != *missing).all()) && given.weight(i) > 0) rows.push_back(i);
  require(!rows.empty(), "fit", "samples", 0, "none has a value and a weight");
  Samples<Dim> some = chosen_samples(given, rows);
  return {std::move(some), std::move(rows)};
}

}  // namespace csrbf
