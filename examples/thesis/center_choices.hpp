#pragma once

#include "csrbf/core/types.hpp"

#include <string>
#include <vector>

namespace csrbf::thesis {

/// Ways to choose centres among samples (thesis 3.1.1, 3.2.2, 6.1.5).
enum class CenterChoice { random, pca, k_means, furthest };

inline constexpr CenterChoice all_choices[] = {CenterChoice::random, CenterChoice::pca, CenterChoice::k_means,
                                               CenterChoice::furthest};

std::string name_of(CenterChoice choice);

/// `count` distinct samples, ascending. pca: the cloud is halved at the centroid across its longest axis, the largest
/// part first; k_means: ten steps of Lloyd's method from random centres; of both the samples nearest to the means.
std::vector<Index> choose_centers(CenterChoice choice, const Points<3>& points, Index count);

}  // namespace csrbf::thesis
