#pragma once

#include "csrbf/approx/global/kriging_variance.hpp"
#include "csrbf/approx/kriging/grown_variance.hpp"
#include "csrbf/io/models/archive.hpp"

#include <functional>
#include <memory>

namespace csrbf {

inline constexpr const char* variance_kind = "kriging variance";
inline constexpr const char* power_kind = "power function";
inline constexpr const char* grown_kind = "variance that grows with the distance to samples";
inline constexpr const char* places_kind = "places of samples";

/// The archive of a power function without its basis.
template <int Dim>
Archive power_to_archive(const PowerFunction<Dim>& power);
template <int Dim>
std::shared_ptr<const PowerFunction<Dim>> power_from(const Archive& archive,
                                                     std::shared_ptr<const RadialBasis<Dim>> basis);

/// The archive of a kriging variance without its power function.
template <int Dim>
Archive variance_to_archive(const KrigingVariance<Dim>& variance);
template <int Dim>
std::shared_ptr<const KrigingVariance<Dim>> variance_from(const Archive& archive,
                                                          std::shared_ptr<const PowerFunction<Dim>> power);

/// In one to three dimensions.
template <int Dim>
Archive places_to_archive(const SamplePlaces<Dim>& places);
template <int Dim>
std::shared_ptr<const SamplePlaces<Dim>> places_from(const Archive& archive);

/// The archive of such a variance without the places; `to_archive` and `from_archive`: of the fields in it.
template <int Dim>
Archive grown_to_archive(const GrownVariance<Dim>& field, const std::function<Archive(const Field<Dim>&)>& to_archive);
template <int Dim>
std::shared_ptr<const GrownVariance<Dim>> grown_from(
    const Archive& archive, std::shared_ptr<const SamplePlaces<Dim>> places,
    const std::function<std::shared_ptr<const Field<Dim>>(const Archive&)>& from_archive);

}  // namespace csrbf
