#pragma once

#include "csrbf/surface/baselines/method_fit.hpp"

/// Earlier methods that make implicit surfaces from points, each in its simplest faithful form, for comparison. All
/// work in the unit coordinates of the cloud and return f > 0 inside.
namespace csrbf::baselines {

/// Signed distance to the tangent plane of the nearest sample (Hoppe et al. 1992).
MethodFit hoppe(const PreparedCloud& cloud, const MethodOptions& options);
/// Sum of Gaussian blobs minus a threshold, blobs split where the errors are largest (Muraki 1991).
MethodFit blobby(const PreparedCloud& cloud, const MethodOptions& options);
/// One CSRBF of a common support at every centre and at two offsets along its normal (Morse et al. 2001).
MethodFit morse(const PreparedCloud& cloud, const MethodOptions& options);
/// Biharmonic spline, phi = r, through all points, 0, and two offsets along their normals; many by fast sums
/// (Carr et al. 2001).
MethodFit carr(const PreparedCloud& cloud, const MethodOptions& options);
/// Triharmonic spline through the centres, 0, and offsets along their normals (Turk and O'Brien 2002).
MethodFit turk_obrien(const PreparedCloud& cloud, const MethodOptions& options);
/// Carrier function, that of a ball, plus a triharmonic spline that cancels it at the centres (Savchenko et al. 1995).
MethodFit savchenko(const PreparedCloud& cloud, const MethodOptions& options);
/// Radial functions stretched along the surface where it is flat or has an edge (Dinh et al. 2001).
MethodFit dinh(const PreparedCloud& cloud, const MethodOptions& options);
/// Levels of CSRBFs with local quadrics, supports halved from level to level (Ohtake et al. 2003).
MethodFit multilevel(const PreparedCloud& cloud, const MethodOptions& options);
/// Normalised quadrics and CSRBFs with supports as large as the error allows (Ohtake et al. 2004).
MethodFit adaptive(const PreparedCloud& cloud, const MethodOptions& options);
/// Partition of unity over an octree, quadrics refined by their error (Ohtake et al. 2003).
MethodFit mpu(const PreparedCloud& cloud, const MethodOptions& options);
/// Partition of unity of triharmonic splines (Tobor et al. 2004).
MethodFit tobor(const PreparedCloud& cloud, const MethodOptions& options);
/// f = n(x) . (a(x) - x) with weighted means of positions and normals (Adamson and Alexa 2003).
MethodFit adamson_alexa(const PreparedCloud& cloud, const MethodOptions& options);
/// Distance to the local polynomial of moving least squares (Levin 1998; Alexa et al. 2001).
MethodFit projection_mls(const PreparedCloud& cloud, const MethodOptions& options);
/// One polynomial: 0 at the samples, +-1 at two offset levels (Blane et al. 2000).
MethodFit three_levels(const PreparedCloud& cloud, const MethodOptions& options);
/// One polynomial with gradients of length 1 at the samples (Tasdizen et al. 2000).
MethodFit gradient_one(const PreparedCloud& cloud, const MethodOptions& options);
/// The same with lengths that bound the effect of errors of the coefficients: in the worst case, and on average
/// (Helzer et al. 2004).
MethodFit min_max(const PreparedCloud& cloud, const MethodOptions& options);
MethodFit min_var(const PreparedCloud& cloud, const MethodOptions& options);

}  // namespace csrbf::baselines
