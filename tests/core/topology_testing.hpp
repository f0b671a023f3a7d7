#pragma once

#include "csrbf/core/mesh.hpp"

#include <gtest/gtest.h>

namespace csrbf {

/// Checks that all counts of two topologies are the same.
inline void expect_equal(const Topology& a, const Topology& b) {
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.edges, b.edges);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.components, b.components);
  EXPECT_EQ(a.boundary_edges, b.boundary_edges);
  EXPECT_EQ(a.nonmanifold_edges, b.nonmanifold_edges);
  EXPECT_EQ(a.nonmanifold_vertices, b.nonmanifold_vertices);
  EXPECT_EQ(a.inconsistent_edges, b.inconsistent_edges);
  EXPECT_EQ(a.euler, b.euler);
}

}  // namespace csrbf
