#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/samples.hpp"

#include <optional>
#include <string>
#include <vector>

namespace csrbf {

struct RobustWeights {
  Eigen::VectorXd factors;          ///< of the weights of the samples; empty: all 1
  std::vector<Index> gross_errors;  ///< samples with a factor below 1/2, in ascending order
  std::vector<Index> suspects;      ///< of few samples those that would be gross errors of many, in ascending order
};

/// What samples count for, by how far they are from what the samples around them say (see local_deviations()): "auto"
/// 0 for gross errors and 1 for all others, "huber" and "student" less and less, "squares" 1. Where axes differ in
/// extent, the smaller of two deviations counts, by the coordinates as they are and by those of equal extents. auto
/// looks at some thousands of the samples, and at all where these have gross errors; a fifth of all samples that
/// deviate are no errors but how the values are distributed, and so are a few that are not very far off, and those
/// whose neighbours are some, too, more often than by chance. Of several samples at one place those are gross errors
/// with which the ones around disagree while they agree with another (of many, if at most a tenth share a place).
/// Where most samples with a mark of missing values (see value_beyond_all_others()) are gross errors, all with it
/// are. Of few samples, less than eight times as many as a local fit takes, which do not tell a gross error from a
/// peak, those that it would leave out are only named: see confirm_errors(). Samples may be at the same points.
template <int Dim>
RobustWeights robust_weights(const Samples<Dim>& samples, const std::string& loss);

/// Says which samples, by number from 0, were left out of so many; names the first ones, counting from 1.
std::string warning_of_gross_errors(const std::vector<Index>& rows, Index samples);
/// The same of suspects, which were kept.
std::string warning_of_suspects(const std::vector<Index>& rows, Index samples);

/// The same of samples with a coordinate that may be wrong: see far_points().
std::string warning_of_far_points(const std::vector<Index>& rows, Index samples);

/// Gives the samples that a report names, in its warnings too, the numbers of their rows, from 0, where sample k is the
/// row rows[k] of a table.
void number_rows(const std::vector<Index>& rows, FitReport& report);

}  // namespace csrbf
