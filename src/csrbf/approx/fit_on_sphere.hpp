#pragma once

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/approx/samples/sphere_field.hpp"

#include <functional>

namespace csrbf {

/// A fit in the plane or in space.
template <int Dim>
using FitSamples = std::function<Fit<Dim>(const Samples<Dim>&, const FitOptions&)>;

/// Fits samples at longitudes and latitudes, see FitOptions::sphere: those of a region in one chart; those of the
/// whole sphere as samples in space where one system is solved or levels are added, and else in six charts, blended.
/// The report lacks the errors at the samples. Throws InvalidInput for latitudes beyond 90 degrees.
template <int Dim>
Fit<Dim> fit_on_sphere(const Samples<Dim>& samples, const FitOptions& options, const FitSamples<Dim>& in_plane,
                       const FitSamples<SphereField<Dim>::space_dim>& in_space);

/// The box of samples whose longitude takes the smallest interval that holds them, beyond 180 degrees where they lie on
/// both sides of the date line; that of the longitudes as they are unless it is a tenth smaller.
template <int Dim>
Box<Dim> box_of_samples(const Samples<Dim>& samples, const FitOptions& options);

/// Throws InvalidInput unless FitOptions::sphere names two of the axes, or none.
void check_sphere(const FitOptions& options, int dimension);

}  // namespace csrbf
