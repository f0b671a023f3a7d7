#pragma once

#include "csrbf/core/types.hpp"

#include <vector>

namespace csrbf {

/// How two points of the plane see each other past faults: directly, or around the end of a fault.
struct Sight {
  bool seen = false;
  double offset = 0;  ///< length of the way from the first point to `corner`
  Point<2> corner;    ///< the first point, or the end of a fault that the way bends around
};

/// Faults: polylines that block the sight. Ends that touch another line, or another end, but for rounding leave no way
/// between.
class FaultLines {
 public:
  /// 2 x vertices each. Throws InvalidInput for lines of fewer than two vertices, and non-finite ones.
  explicit FaultLines(std::vector<Eigen::Matrix2Xd> lines);

  [[nodiscard]] const std::vector<Eigen::Matrix2Xd>& lines() const { return lines_; }

  /// The segments and ends of lines within a distance from p.
  struct Nearby {
    std::vector<Index> segments, ends;
  };
  [[nodiscard]] Nearby within(const Point<2>& p, double distance) const;

  /// The shortest way from p to q that crosses none of these segments, straight or around one of these ends. A point on
  /// a fault is on the side to which the segment from p comes.
  [[nodiscard]] Sight sight(const Point<2>& p, const Point<2>& q, const Nearby& nearby) const;

 private:
  [[nodiscard]] bool goes_on(Index segment, const Point<2>& end, const Point<2>& before, double reach) const;
  [[nodiscard]] bool crosses(const Point<2>& p, const Point<2>& q, const std::vector<Index>& segments) const;

  std::vector<Eigen::Matrix2Xd> lines_;
  Eigen::Matrix2Xd from_, to_;  // segments
  Eigen::Matrix2Xd ends_;       // of lines, from which no other one goes on
};

}  // namespace csrbf
