#pragma once

#include "csrbf/approx/basis/radial_basis.hpp"
#include "csrbf/approx/faults/fault_field.hpp"
#include "csrbf/approx/hermite/hermite_field.hpp"
#include "csrbf/approx/moving/moving_least_squares.hpp"
#include "csrbf/approx/moving/moving_least_squares_field.hpp"
#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/io/models/archive.hpp"

namespace csrbf {

/// Converts parts that several fields share to archives and back. Reading throws IoError or InvalidInput for missing
/// or inconsistent entries.

template <int Dim>
Archive to_archive(const RadialBasis<Dim>& basis);
template <int Dim>
std::shared_ptr<const RadialBasis<Dim>> basis_from(const Archive& archive);

template <int Dim>
Archive patches_to_archive(const typename PartitionOfUnity<Dim>::Data& data);
template <int Dim>
std::shared_ptr<const typename PartitionOfUnity<Dim>::Data> patches_from(const Archive& archive);

template <int Dim>
Archive samples_to_archive(const typename MovingLeastSquares<Dim>::Data& data);
template <int Dim>
std::shared_ptr<const typename MovingLeastSquares<Dim>::Data> samples_from(const Archive& archive);

template <int Dim>
Archive hermite_to_archive(const typename HermiteField<Dim>::Data& data);
template <int Dim>
std::shared_ptr<const typename HermiteField<Dim>::Data> hermite_from(const Archive& archive);

Archive faults_to_archive(const FaultField::Data& data);
std::shared_ptr<const FaultField::Data> faults_from(const Archive& archive);

/// The kind of the archives above.
inline constexpr const char* basis_kind = "radial basis";
inline constexpr const char* patches_kind = "cover and local functions";
inline constexpr const char* samples_kind = "samples";
inline constexpr const char* faults_kind = "discs past faults";
inline constexpr const char* hermite_kind = "systems of values and derivatives";

/// Largest degree of a polynomial that is read: a limit on damaged files, above what fits use.
inline constexpr int most_degree = 20;

/// A number that must be positive and finite.
double positive_number(const Archive& archive, const std::string& name);

}  // namespace csrbf
