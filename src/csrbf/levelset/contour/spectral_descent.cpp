#include "csrbf/levelset/contour/spectral_descent.hpp"

#include "csrbf/levelset/lattice/coefficient_sums.hpp"

#include <algorithm>

namespace csrbf {

int spectral_descent(const DescentEnergy& energy, const DescentOptions& options, std::vector<float>& x,
                     std::vector<double>& energies) {
  constexpr double enough = 1e-4;    // share of the decrease that the slope promises: Armijo's, conventional
  constexpr int most_attempts = 10;  // each at least halves the step: at most 1e-3 of it is left
  const float limit = options.limit;
  const std::size_t n = x.size();
  std::vector<float> gradient(n), next(n), next_gradient(n), step(n);
  double E = energy(x.data(), gradient.data());
  energies.push_back(E);
  const double first = E;
  double rate = options.rate;
  int used = 1;
  while (used < options.iterations) {
    for_all(n, [&](std::size_t i) {  // what starts beyond the limit may come back in its own time
      step[i] =
          std::clamp(x[i] - static_cast<float>(rate) * gradient[i], std::min(-limit, x[i]), std::max(limit, x[i])) -
          x[i];
    });
    const double slope = dot(gradient, step);
    if (!(slope < 0)) break;
    double part = 1, E_next = E;
    bool lower = false;
    for (int attempt = 0; attempt < most_attempts && !lower; ++attempt, ++used) {
      for_all(n, [&](std::size_t i) { next[i] = x[i] + static_cast<float>(part) * step[i]; });
      E_next = energy(next.data(), next_gradient.data());
      lower = E_next <= E + enough * part * slope;
      if (!lower) part *= std::clamp(-0.5 * part * slope / (E_next - E - part * slope), 0.1, 0.5);
    }
    if (!lower || !(E_next < E)) break;
    const double ss = sum_of(n, [&](std::size_t i) {
      const double s = static_cast<double>(next[i] - x[i]);
      return s * s;
    });
    const double sy = sum_of(n, [&](std::size_t i) {
      return static_cast<double>(next[i] - x[i]) * static_cast<double>(next_gradient[i] - gradient[i]);
    });
    rate = sy > 0 ? ss / sy : 2 * rate;
    x.swap(next);
    gradient.swap(next_gradient);
    const double decrease = E - E_next;
    E = E_next;
    energies.push_back(E);
    if (decrease < options.tolerance * (first - E)) break;
  }
  return used;
}

}  // namespace csrbf
